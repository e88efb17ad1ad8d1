// Rows of joints and body joined by their time.
#include "components/model/stance_fit/file/stance_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "components/base/config/config.h"

namespace sinew::stance_fit {
namespace {

using ::testing::HasSubstr;

constexpr double kRowPeriod_s = 0.005;

actuator::RobotModel TwoJoints() {
  actuator::RobotModel robot;
  robot.name = "two";
  for (const char* name : {"left", "right"}) {
    actuator::JointModel joint;
    joint.name = name;
    joint.terms.push_back(actuator::MakeTerm("drive_torque", joint.constants));
    robot.joints.push_back(joint);
  }
  return robot;
}

// Values are numbers of rows.
types::Run Counting(Eigen::Index rows) {
  types::Run run;
  run.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, kRowPeriod_s * static_cast<double>(rows - 1));
  const Eigen::VectorXd count =
      Eigen::VectorXd::LinSpaced(rows, 0.0, static_cast<double>(rows - 1));
  run.signals[types::Signal::kPosition] = count;
  run.signals[types::Signal::kTorque] = -count;
  return run;
}

recording::BodyRun CountingBody(const types::Run& like) {
  const Eigen::Index rows = like.size();
  recording::BodyRun body;
  body.time_s = like.time_s;
  body.foot_force_N = like.At(types::Signal::kPosition) * Eigen::RowVectorXd::Ones(8);
  body.orientation_wxyz = Eigen::RowVector4d(1.0, 0.0, 0.0, 0.0).replicate(rows, 1);
  body.angular_velocity_rad_s = Eigen::MatrixXd::Zero(rows, 3);
  return body;
}

types::Run Without(const types::Run& run, Eigen::Index first, Eigen::Index count) {
  types::Run out = run;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    if (i < first || i >= first + count) kept.push_back(i);
  }
  out.time_s = run.time_s(kept);
  for (auto& [signal, values] : out.signals) values = run.signals.at(signal)(kept).eval();
  return out;
}

TEST(JoinRows, KeepsTheRowsThatAllHave) {
  const types::Run whole = Counting(600);
  const types::Run late = Without(whole, 0, 10);  // this joint was valid from row 10 on
  const std::vector<StanceRecording> pieces =
      JoinRows("a.mcap", TwoJoints(), {whole, late}, CountingBody(whole));
  ASSERT_EQ(pieces.size(), 1u);
  const StanceRecording& piece = pieces.front();
  EXPECT_EQ(piece.name, "a.mcap");
  EXPECT_NEAR(piece.period_s, kRowPeriod_s, 1e-12);
  ASSERT_EQ(piece.size(), 590);
  for (const types::Run& joint : piece.joints) {
    ASSERT_EQ(joint.size(), 590);
    EXPECT_EQ(joint.At(types::Signal::kPosition)[0], 10.0);
    EXPECT_EQ(joint.At(types::Signal::kTorque)[589], -599.0);
  }
  EXPECT_EQ(piece.foot_force_N(0, 3), 10.0);
}

TEST(JoinRows, CutsAtAHoleAndLeavesOutShortPieces) {
  const types::Run whole = Counting(1200);
  // One row is lost at 100: the 0.5 s before it are too short. Ten at 700.
  types::Run holes = Without(Without(whole, 700, 10), 100, 1);
  const std::vector<StanceRecording> pieces =
      JoinRows("a.mcap", TwoJoints(), {whole, holes}, CountingBody(whole));
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].joints[0].At(types::Signal::kPosition)[0], 101.0);
  EXPECT_EQ(pieces[0].size(), 599);
  EXPECT_EQ(pieces[1].joints[1].At(types::Signal::kPosition)[0], 710.0);
  EXPECT_EQ(pieces[1].size(), 490);
}

std::string ErrorOf(const std::vector<types::Run>& joints, const recording::BodyRun& body) {
  try {
    JoinRows("a.mcap", TwoJoints(), joints, body);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(JoinRows, NamesTheJointAndSignalThatIsNotMeasured) {
  const types::Run whole = Counting(600);
  types::Run silent = whole;
  silent.signals.erase(types::Signal::kTorque);
  const std::string error = ErrorOf({whole, silent}, CountingBody(whole));
  EXPECT_THAT(error, HasSubstr("a.mcap: joint 'right'"));
  EXPECT_THAT(error, HasSubstr("torque"));
}

TEST(JoinRows, RefusesRowsThatNeverMeetAndRecordingsThatAreTooShort) {
  const types::Run whole = Counting(600);
  recording::BodyRun elsewhere = CountingBody(whole);
  elsewhere.time_s.array() += 0.5 * kRowPeriod_s;
  EXPECT_THAT(ErrorOf({whole, whole}, elsewhere), HasSubstr("share 0 rows"));
  const types::Run brief = Counting(100);
  EXPECT_THAT(ErrorOf({brief, brief}, CountingBody(brief)), HasSubstr("share 100 rows"));
}

TEST(ReadStance, RefusesACsvFileByItsName) {
  try {
    ReadStance("squat.csv", TwoJoints());
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("squat.csv"));
    EXPECT_THAT(error.what(), HasSubstr("foot_force"));
  }
}

}  // namespace
}  // namespace sinew::stance_fit
