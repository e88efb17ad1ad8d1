// What dropping an effect costs a robot of two joints. Oracle: a recording whose torques are those
// of known bodies and friction; the error without an effect is the effect's own torque.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/bodies/dynamics/dynamics.h"
#include "tests/components/bodies/dynamics/random_arm.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tools/export_model/cost.h"
#include "tools/export_model/write_model.h"

namespace sinew::export_model {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using types::Signal;

constexpr double kViscous = 0.5;        // N m s/rad, of both joints
constexpr double kOffset_Nm = 0.2;      // of the first joint
constexpr double kQuadraticDrag = 0.3;  // N m s^2/rad^2, of the second joint
constexpr double kSecondOffset_Nm = 0.1;
constexpr double kRate_Hz = 200.0;
constexpr double kRest_rad_s = 0.03, kGuard_s = 0.05, kBorder_s = 0.5;  // rows left out
// What the filters of both sides take away and what they spread over the rows that count.
constexpr double kShare = 0.03;

arm::Chain TwoJoints() {
  arm::Chain chain;
  chain.name = "two_joints";
  chain.bodies.push_back(arm::LinkOf("one", -1, {0.0, 0.1, 0.3}, {0.0, 0.3, 1.0}, 2.0));
  chain.bodies.push_back(arm::LinkOf("two", 0, {0.2, 0.0, 0.1}, {0.0, 1.0, 0.2}, 1.3));
  return chain;
}

actuator::RobotModel ModelOfTwo(bool rigid) {
  actuator::RobotModel robot;
  robot.name = "two";
  for (const std::string name : {"one", "two"}) {
    actuator::JointModel joint;
    joint.name = name;
    const auto add = [&joint](const char* effect, double value) {
      joint.terms.push_back(actuator::MakeTerm(effect, joint.constants));
      joint.terms.back().linear[0].value = value;
    };
    add("drive_torque", 1.0);
    if (rigid) add("rigid_body", 1.0);
    add("viscous", kViscous);
    add("offset", name == "one" ? -kOffset_Nm : -kSecondOffset_Nm);
    if (name == "two") add("quadratic_viscous", kQuadraticDrag);
    robot.joints.push_back(joint);
  }
  return robot;
}

struct RecordedTwo {
  std::vector<std::vector<types::Run>> runs;
  double drag_rms_Nm = 0.0;  // of the second joint's quadratic drag, over the rows that count
};

// Over rows that are not within the guard of a row at rest, and not at the borders.
double RmsOfMoving(const Eigen::VectorXd& value, const Eigen::VectorXd& velocity_rad_s) {
  const auto guard = static_cast<Eigen::Index>(kGuard_s * kRate_Hz);
  const auto border = static_cast<Eigen::Index>(kBorder_s * kRate_Hz);
  double squares = 0.0, rows = 0.0;
  for (Eigen::Index i = border; i < value.size() - border; ++i) {
    if (velocity_rad_s.segment(i - guard, 2 * guard + 1).cwiseAbs().minCoeff() < kRest_rad_s) {
      continue;
    }
    squares += value[i] * value[i];
    rows += 1.0;
  }
  return std::sqrt(squares / rows);
}

RecordedTwo RecordTwo(bool rigid) {
  const arm::ArmDynamics bodies(TwoJoints());
  const auto rows = static_cast<Eigen::Index>(20.0 * kRate_Hz);
  types::Run run;
  run.name = "held_out";
  run.time_s = Eigen::VectorXd::LinSpaced(rows, 0.0, static_cast<double>(rows - 1) / kRate_Hz);
  run.signals[Signal::kPosition] = Eigen::VectorXd(rows);
  run.signals[Signal::kTorque] = Eigen::VectorXd(rows);
  RecordedTwo out;
  out.runs = {{run}, {run}};
  constexpr double kAmplitude_rad[] = {0.8, 0.4}, kFrequency_Hz[] = {0.23, 0.61};
  Eigen::VectorXd drag_Nm(rows), velocity_rad_s(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(2), v = q, a = q;
    for (int j = 0; j < 2; ++j) {
      for (int k = 0; k < 2; ++k) {
        const double w = 2.0 * M_PI * kFrequency_Hz[k] * (1.0 + 0.13 * j);
        const double angle = w * run.time_s[i] + 0.7 * j + 1.1 * k;
        q[j] += kAmplitude_rad[k] * std::sin(angle);
        v[j] += kAmplitude_rad[k] * w * std::cos(angle);
        a[j] -= kAmplitude_rad[k] * w * w * std::sin(angle);
      }
    }
    Eigen::VectorXd torque = kViscous * v;
    if (rigid) torque += bodies.Torque(q, v, a, bodies.nominal());
    velocity_rad_s[i] = v[1];
    drag_Nm[i] = kQuadraticDrag * v[1] * std::abs(v[1]);
    torque[0] += kOffset_Nm;
    torque[1] += kSecondOffset_Nm + drag_Nm[i];
    for (int j = 0; j < 2; ++j) {
      auto& signals = out.runs[static_cast<std::size_t>(j)][0].signals;
      signals[Signal::kPosition][i] = q[j];
      signals[Signal::kTorque][i] = torque[j];
    }
  }
  out.drag_rms_Nm = RmsOfMoving(drag_Nm, velocity_rad_s);
  return out;
}

// Cut-offs far above the motion, whose drag has its third harmonic at 2 Hz.
identify::ProcessingOptions WideOptions() {
  identify::ProcessingOptions options;
  options.state_cutoff_Hz = 40.0;
  options.parallel_cutoff_Hz = 15.0;
  options.rest_velocity = kRest_rad_s;
  options.reversal_guard_s = kGuard_s;
  options.border_s = kBorder_s;
  return options;
}

const Cost& CostOf(const Costs& costs, const std::string& joint, const std::string& effect) {
  for (const Cost& cost : costs.of) {
    if (cost.joint == joint && cost.effect == effect) return cost;
  }
  throw std::out_of_range("no cost of " + effect);
}

void HasTheKnownCosts(bool rigid) {
  const actuator::RobotModel robot = ModelOfTwo(rigid);
  const RecordedTwo recorded = RecordTwo(rigid);
  const std::vector<Dropped> dropped = DroppedBy(Format::kUrdf, robot);
  ASSERT_EQ(dropped.size(), 3u);  // two offsets and the drag
  const Costs costs = TorqueCostsOf(dropped, robot, TwoJoints(), recorded.runs, WideOptions());
  EXPECT_EQ(costs.measure, Measure::kPredictedTorque);
  ASSERT_EQ(costs.of.size(), 4u) << "each, and all of the second joint";
  EXPECT_EQ(costs.of[3].effect, "all");
  for (const Cost& cost : costs.of) {
    ASSERT_TRUE(cost.without && cost.with) << cost.effect << cost.why_not;
    EXPECT_LT(*cost.with, 0.005) << "the model is that of the recording";
  }
  const double drag_Nm = recorded.drag_rms_Nm;
  EXPECT_GT(drag_Nm, 0.5);
  EXPECT_NEAR(*CostOf(costs, "one", "offset").without, kOffset_Nm, 0.01 * kOffset_Nm);
  EXPECT_NEAR(*CostOf(costs, "two", "offset").without, kSecondOffset_Nm, 0.01 * kSecondOffset_Nm);
  EXPECT_NEAR(*CostOf(costs, "two", "quadratic_viscous").without, drag_Nm, kShare * drag_Nm);
  const double all_Nm = std::hypot(drag_Nm, kSecondOffset_Nm);
  EXPECT_NEAR(*CostOf(costs, "two", "all").without, all_Nm, kShare * all_Nm);
}

TEST(TorqueCosts, OfAnArmAreTheTorquesOfTheDroppedEffects) { HasTheKnownCosts(true); }

TEST(TorqueCosts, OfJointsWithoutRigidBodiesAreThoseOfTheirOwnBalance) { HasTheKnownCosts(false); }

TEST(TorqueCosts, NameWhatTheyAreOf) {
  actuator::RobotModel robot = ModelOfTwo(true);
  robot.joints[0].backlash_rad = 0.01;
  const std::vector<Dropped> dropped = DroppedBy(Format::kUrdf, robot);
  const Costs costs =
      TorqueCostsOf(dropped, robot, TwoJoints(), RecordTwo(true).runs, WideOptions());
  EXPECT_EQ(CostOf(costs, "one", "backlash").why_not, "it has no part in the balance of torque");
  std::string text;
  for (const std::string& remark :
       MakeRemarks(Format::kUrdf, robot, {}, "model.yaml", dropped, costs, "held_out.csv")) {
    text += remark + "\n";
  }
  EXPECT_THAT(text, HasSubstr("Errors below: the torque that each joint needs for the motion of "
                              "held_out.csv, predicted by its balance"));
  EXPECT_THAT(text, HasSubstr("joint one, offset (offset_Nm = -0.2); predicted torque wrong by 0.2 "
                              "Nm rms without, by "));
  EXPECT_THAT(text, HasSubstr("joint one, backlash (backlash_rad = 0.01); it has no part in the "
                              "balance of torque."));
  EXPECT_THAT(text, HasSubstr("All of these of joint two; predicted torque wrong by "));
}

TEST(TorqueCosts, OfARobotOnItsFeetAreRefused) {
  actuator::RobotModel robot = ModelOfTwo(true);
  robot.floating_base.emplace();
  EXPECT_THROW(TorqueCostsOf({}, robot, TwoJoints(), RecordTwo(true).runs, WideOptions()),
               std::invalid_argument);
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string UrdfOfTwo() {
  std::string text = "<robot name=\"two_joints\">\n  <link name=\"base\"/>\n";
  std::string parent = "base";
  for (const arm::Body& body : TwoJoints().bodies) {
    const auto triple = [](const Eigen::Vector3d& v) {
      return Number(v.x()) + " " + Number(v.y()) + " " + Number(v.z());
    };
    const Eigen::Matrix3d& inertia = body.inertia_kg_m2;
    text += "  <link name=\"" + body.link_name + "\"><inertial><origin xyz=\"" +
            triple(body.com_m) + "\"/><mass value=\"" + Number(body.mass_kg) +
            "\"/><inertia ixx=\"" + Number(inertia(0, 0)) + "\" ixy=\"" + Number(inertia(0, 1)) +
            "\" ixz=\"" + Number(inertia(0, 2)) + "\" iyy=\"" + Number(inertia(1, 1)) +
            "\" iyz=\"" + Number(inertia(1, 2)) + "\" izz=\"" + Number(inertia(2, 2)) +
            "\"/></inertial></link>\n  <joint name=\"" + body.joint_name +
            "\" type=\"revolute\"><parent link=\"" + parent + "\"/><child link=\"" +
            body.link_name + "\"/><origin xyz=\"" + triple(body.parent_from_joint.translation()) +
            "\"/><axis xyz=\"" + triple(body.axis) +
            "\"/><limit lower=\"-3\" upper=\"3\" effort=\"50\" velocity=\"9\"/></joint>\n";
    parent = body.link_name;
  }
  return text + "</robot>\n";
}

TEST(ExportModelCommand, WritesTheCostsOfARobotOfTwoJoints) {
  const testing::TemporaryFolder folder;
  folder.Write("two.urdf", UrdfOfTwo());
  const auto joint = [](const std::string& name, const std::string& terms) {
    return "  - name: " + name +
           "\n    kind: rotary\n    terms:\n"
           "      - {effect: drive_torque, gain: {value: 1, fixed: true}}\n"
           "      - {effect: rigid_body, share: {value: 1, fixed: true}}\n"
           "      - {effect: viscous, viscous_Nm_s_rad: 0.5}\n" +
           terms;
  };
  const std::string model = folder.Write(
      "model.yaml",
      "schema: sinew-model/1\nname: two\nurdf: two.urdf\njoints:\n" +
          joint("one", "      - {effect: offset, offset_Nm: -0.2}\n") +
          joint("two",
                "      - {effect: offset, offset_Nm: -0.1}\n"
                "      - {effect: quadratic_viscous, quadratic_Nm_s2_rad2: 0.3}\n") +
          "processing: {state_cutoff_Hz: 40, parallel_cutoff_Hz: 15, rest_velocity_rad_s: 0.03}\n");
  const std::string map = folder.Write(
      "map.yaml",
      "schema: sinew-csv-map/1\nkind: rotary\njoints: 2\ntime: {column: t, unit: s}\nsignals:\n"
      "  position: {column: \"q{joint}\", unit: rad}\n"
      "  torque: {column: \"tau{joint}\", unit: Nm}\n");
  const RecordedTwo recorded = RecordTwo(true);
  std::string csv = "t,q1,q2,tau1,tau2\n";
  const types::Run &one = recorded.runs[0][0], &two = recorded.runs[1][0];
  for (Eigen::Index i = 0; i < one.size(); ++i) {
    csv += Number(one.time_s[i]) + "," + Number(one.At(Signal::kPosition)[i]) + "," +
           Number(two.At(Signal::kPosition)[i]) + "," + Number(one.At(Signal::kTorque)[i]) + "," +
           Number(two.At(Signal::kTorque)[i]) + "\n";
  }
  const std::string out = (folder.path() / "out.urdf").string();
  const testing::Finished done =
      testing::Run({kSinew, "export-model", model, "--format", "urdf", "--recording",
                    folder.Write("held_out.csv", csv), "--map", map, "--out", out, "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.output << done.error;
  const auto json = nlohmann::json::parse(done.output);
  EXPECT_EQ(json["measure"], "predicted_torque");
  ASSERT_EQ(json["dropped"].size(), 4u) << done.output;
  const auto& drag = json["dropped"][2];
  EXPECT_EQ(drag["joint"], "two");
  EXPECT_EQ(drag["effect"], "quadratic_viscous");
  EXPECT_EQ(drag["unit"], "Nm");
  EXPECT_NEAR(drag["rms_without"], recorded.drag_rms_Nm, kShare * recorded.drag_rms_Nm);
  EXPECT_LT(drag["rms_with"], 0.005);
  EXPECT_EQ(json["dropped"][3]["effect"], "all");
  EXPECT_THAT(config::ReadFile(out),
              HasSubstr("robots of several joints are not simulated beside a recording"));
}

}  // namespace
}  // namespace sinew::export_model
