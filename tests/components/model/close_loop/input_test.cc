// What close-loop accepts as input, and what it refuses with the reason.
#include "components/model/close_loop/input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "components/base/config/config.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/report/file/section_file.h"
#include "tests/components/model/close_loop/example_options.h"
#include "tests/components/model/trace/plain_fit.h"
#include "tests/support/temporary_folder.h"

namespace sinew::close_loop {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string ErrorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  }
  return "no error";
}

constexpr double kStiffness = 2.5, kRest = 0.3, kCoulomb = 0.4;

// A spring without inertia moved slowly, 100 Hz, 20 s, recorded to 1e-6 Nm.
std::string SpringCsv(double start_s = 0.0) {
  std::string csv = "t,q,v,tau\n";
  char row[128];
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.01 * k;
    const double q = 0.8 * std::sin(0.9 * t) + 0.3 * std::sin(2.3 * t + 0.4);
    const double v = 0.72 * std::cos(0.9 * t) + 0.69 * std::cos(2.3 * t + 0.4);
    const double tau = kStiffness * (q - kRest) + kCoulomb * (v > 0.0 ? 1.0 : -1.0);
    std::snprintf(row, sizeof row, "%.3f,%.9f,%.9f,%.6f\n", start_s + t, q, v, tau);
    csv += row;
  }
  return csv;
}

const char* const kSpringModel = R"(schema: sinew-model/1
name: spring
joints:
  - name: j
    kind: rotary
    terms:
      - {effect: drive_torque, gain: {value: 1, fixed: true}}
      - {effect: spring, stiffness_Nm_rad: {value: 2, tolerance: 0.5}, preload_Nm: 0}
      - {effect: coulomb, coulomb_Nm: {value: 0, tolerance: {absolute: 0.5}}}
    history: []
)";

class CloseLoopInput : public ::testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  Options SpringOptions() {
    Options options = BasicOptions();
    options.model = Write("model.yaml", kSpringModel);
    options.map = Write("csv_map.yaml",
                        "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\n"
                        "signals:\n  position: {column: q, unit: rad}\n"
                        "  torque: {column: tau, unit: Nm}\n");
    const std::string csv = Write("day.csv", SpringCsv());
    options.train = {csv + "@:12"};
    options.held_out = {csv + "@12:"};
    return options;
  }
  testing::TemporaryFolder folder_;
};

TEST_F(CloseLoopInput, ASpringAndAJointWithoutInertiaAreFitted) {
  const Options options = SpringOptions();
  const Input input = LoadInput(options);
  const actuator::JointModel& joint = input.model.robot.joints[0];
  const std::vector<types::Run> train = ReadJoint(options.train, input.map, 0);
  const std::vector<types::Run> held_out = ReadJoint(options.held_out, input.map, 0);
  EXPECT_EQ(train[0].size() + held_out[0].size(), 2000);
  EXPECT_EQ(train[0].name, "day.csv@:12");
  const identify::ProcessingOptions processing =
      identify::Resolve(identify::ReadProcessing(input.model.root, joint.kind), train);
  const identify::Design design(identify::MakeStates(train, joint, processing), processing);
  const identify::FitResult fit = trace::PlainFit(design, joint);
  // The parallel filter rounds the step of dry friction off, which costs a per mille.
  EXPECT_NEAR(fit.model.Parameter("spring", "stiffness"), kStiffness, 0.01);
  EXPECT_NEAR(fit.model.Parameter("spring", "preload"), kStiffness * kRest, 0.01);
  EXPECT_NEAR(fit.model.Parameter("coulomb", "coulomb"), kCoulomb, 0.01);
  const Result result = CloseLoop(options);
  EXPECT_LT(result.joints[0].trace.before_held_out.percent, 1.0);
}

TEST_F(CloseLoopInput, OneRecordingAndNothingHeldOutIsRefusedWithTheWayToSplitIt) {
  Options options = SpringOptions();
  options.train = {folder_.path() / "day.csv"};
  options.held_out.clear();
  const std::string csv = options.train[0].string();
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }),
              HasSubstr("--train " + csv + "@:13 --held-out " + csv + "@13:"));
}

// Stamps since 1970, as every live robot has.
TEST_F(CloseLoopInput, StampsKeepTheirDigits) {
  constexpr double kEpoch_s = 1'700'000'000.25;
  Options options = SpringOptions();
  const std::string csv = Write("epoch.csv", SpringCsv(kEpoch_s));
  options.train = {csv};
  options.held_out.clear();
  const std::string split = "--train " + csv + "@:1700000014 --held-out " + csv + "@1700000014:";
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }), HasSubstr(split));
  options.train = {csv + "@:1700000014"};
  options.held_out = {csv + "@1700000014:"};
  options.given = {"stribeck"};
  const Result result = CloseLoop(options);
  EXPECT_LT(result.joints[0].trace.before_held_out.percent, 1.0);
  EXPECT_THAT(report::DrawnHtml(result.page), AllOf(HasSubstr("<svg"), Not(HasSubstr("1.7e+09"))));
  // A fault of the data has its page and pictures as well.
  std::istringstream good(SpringCsv(kEpoch_s));
  std::string spikes, line;
  for (int row = 0; std::getline(good, line); ++row) {
    spikes += (row % 150 == 75 ? line.substr(0, line.rfind(',')) + ",90" : line) + "\n";
  }
  Write("epoch.csv", spikes);
  const Result fault = CloseLoop(options);
  EXPECT_THAT(fault.json, HasSubstr("\"verdict\": \"data_fault\""));
  EXPECT_THAT(report::DrawnHtml(fault.page), AllOf(HasSubstr("<svg"), Not(HasSubstr("1.7e+09"))));
}

TEST_F(CloseLoopInput, ASimulationNeedsInertiaAndAHeldOutRecording) {
  Options options = SpringOptions();
  options.by_simulation = true;
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }), HasSubstr("inertia"));
  options.held_out.clear();
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }), HasSubstr("expected --held-out"));
}

TEST_F(CloseLoopInput, WithoutHeldOutRecordingsEachIsHeldOutOnce) {
  Options options = SpringOptions();
  const std::string csv = folder_.path() / "day.csv";
  options.train = {csv + "@:10", csv + "@10:"};
  options.held_out.clear();
  const Result result = CloseLoop(options);
  ASSERT_EQ(result.joints[0].rotations.size(), 2u);
  EXPECT_EQ(result.joints[0].rotations[1].held_out, "day.csv@10:");
  EXPECT_THAT(result.json, HasSubstr("\"held_out\": \"day.csv@:10\""));
  EXPECT_THAT(report::FormatHtml(result.page), HasSubstr("Each recording held out once"));
}

TEST_F(CloseLoopInput, AnEffectThatIsGivenIsFittedWhateverItIsWorth) {
  Options options = SpringOptions();
  options.given = {"stribeck"};
  const Result result = CloseLoop(options);
  ASSERT_EQ(result.joints[0].trace.effects.size(), 1u);
  EXPECT_EQ(result.joints[0].trace.effects[0].name, "stribeck");
  EXPECT_TRUE(result.joints[0].trace.effects[0].in_model());
  EXPECT_TRUE(result.joints[0].trace.refuted.empty());
  EXPECT_THAT(result.json, HasSubstr("Given, not searched for: stribeck."));
}

TEST_F(CloseLoopInput, WithNoEffectGivenTheDeclaredTermsStayAlone) {
  Options options = SpringOptions();
  options.given.emplace();
  const Result result = CloseLoop(options);
  EXPECT_TRUE(result.joints[0].trace.effects.empty());
  EXPECT_THAT(result.json, HasSubstr("Given, not searched for: no effect."));
  EXPECT_THAT(result.json, Not(HasSubstr("beyond the declared model")));
  EXPECT_THAT(result.json, Not(HasSubstr("no effect of the catalogue")));
}

TEST_F(CloseLoopInput, AnEffectThatTheRecordingsCannotShowIsSaidToBeOpen) {
  Options options = SpringOptions();
  options.given = {"leak"};  // there is no gas
  const Result result = CloseLoop(options);
  EXPECT_TRUE(result.joints[0].trace.effects.empty());
  EXPECT_THAT(result.json, HasSubstr("These recordings do not determine a size of leak."));
}

TEST_F(CloseLoopInput, RangesOfOneFileMayNotShareRows) {
  Options options = SpringOptions();
  const std::string csv = folder_.path() / "day.csv";
  options.held_out = {csv + "@11:"};
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }),
              AllOf(HasSubstr("day.csv@11:"), HasSubstr("day.csv@:12"), HasSubstr("shares rows")));
  options.held_out = {csv};
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }), HasSubstr("shares rows"));
  options.held_out = {csv + "@30:60"};
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }),
              AllOf(HasSubstr("day.csv"), HasSubstr("'30:60'"), HasSubstr("0 to 19.99 s")));
  options.held_out = {csv + "@60:30"};
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }),
              AllOf(HasSubstr("day.csv"), HasSubstr("'60:30'"), HasSubstr("START:END")));
}

TEST_F(CloseLoopInput, AVelocityWithoutAnAngleIsRefusedWithTheReason) {
  Options options = SpringOptions();
  options.map = Write("velocity.yaml",
                      "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\n"
                      "signals:\n  velocity: {column: v, unit: rad/s}\n"
                      "  torque: {column: tau, unit: Nm}\n");
  EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }),
              AllOf(HasSubstr("day.csv"), HasSubstr("velocity without an angle"),
                    HasSubstr("drifts"), HasSubstr("position or motor_position")));
}

TEST_F(CloseLoopInput, TheZeroOfAnEncoderGoesWithTheRecording) {
  Options options = SpringOptions();
  options.map = Write("zero.yaml",
                      "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\n"
                      "signals:\n  position: {column: q, unit: rad, zero_per_recording: true}\n"
                      "  torque: {column: tau, unit: Nm}\n");
  const std::vector<types::Run> runs = ReadJoint(options.train, options.map, 0);
  EXPECT_EQ(runs[0].zero_unknown, std::set<types::Signal>{types::Signal::kPosition});
}

TEST_F(CloseLoopInput, AnArmWithoutItsUrdfIsRefusedWithTheReason) {
  for (const char* robot : {"franka_panda", "schunk_arm", "kuka_lwr4"}) {
    const fs::path folder = fs::path(SINEW_SOURCE_DIR) / "robots" / robot;
    Options options = BasicOptions();
    const bool alone = !fs::exists(folder / "model_arm.yaml");
    options.model = folder / (alone ? "model.yaml" : "model_arm.yaml");
    options.map = Write("map.yaml",
                        "schema: sinew-csv-map/1\nkind: rotary\njoints: 7\n"
                        "time: {column: t, unit: s}\n"
                        "signals:\n  position: {column: q, unit: rad}\n"
                        "  torque: {column: tau, unit: Nm}\n");
    const std::string csv = Write("day.csv", SpringCsv());
    options.train = {csv + "@:12"};
    options.held_out = {csv + "@12:"};
    EXPECT_THAT(ErrorOf([&] { CloseLoop(options); }),
                AllOf(HasSubstr(options.model.filename().string()), HasSubstr("rigid_body"),
                      HasSubstr("--urdf")))
        << robot;
  }
}

// The joints of an arm are fitted together: a fault of one leaves a report to each.
TEST_F(CloseLoopInput, AFaultOfOneJointOfAnArmIsReportedByEach) {
  Options options = BasicOptions();
  options.model = fs::path(SINEW_SOURCE_DIR) / "robots/kuka_lwr4/model.yaml";
  options.map = Write("map.yaml",
                      "schema: sinew-csv-map/1\nkind: rotary\njoints: 7\n"
                      "time: {column: t, unit: s}\n"
                      "signals:\n  position: {column: q, unit: rad}\n"
                      "  torque: {column: \"tau{joint}\", unit: Nm}\n");
  std::istringstream spring(SpringCsv());
  std::string csv = "t,q,tau1,tau2,tau3,tau4,tau5,tau6,tau7\n", line;
  std::getline(spring, line);
  for (int row = 0; std::getline(spring, line); ++row) {
    const std::size_t q = line.find(','), v = line.find(',', q + 1), tau = line.find(',', v + 1);
    csv += line.substr(0, v);
    for (int joint = 1; joint <= 7; ++joint) {
      csv += joint == 3 && row % 150 == 75 ? ",90" : line.substr(tau);
    }
    csv += "\n";
  }
  const std::string day = Write("day.csv", csv);
  options.train = {day + "@:12"};
  options.held_out = {day + "@12:"};
  const Result result = CloseLoop(options);
  ASSERT_EQ(result.joints.size(), 7u);
  EXPECT_FALSE(result.arm);
  for (std::size_t j = 0; j < 7; ++j) {
    const gate::GateReport& gate = result.joints[j].gate;
    ASSERT_FALSE(gate.faults.empty()) << j;
    EXPECT_EQ(gate.faults[0].rule, "spike") << j;
    EXPECT_EQ(gate.faults[0].signal, j == 2 ? "torque" : "torque of joint 'lwr_2_joint'");
    EXPECT_THAT(result.parts[j].json, HasSubstr("\"verdict\": \"data_fault\"")) << j;
    if (j == 2) continue;
    EXPECT_THAT(report::FormatHtml(result.parts[j].page), HasSubstr("the arm was not fitted")) << j;
  }
}

}  // namespace
}  // namespace sinew::close_loop
