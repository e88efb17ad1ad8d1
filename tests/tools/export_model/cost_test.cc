// What dropping an effect costs, and the command. Oracle: a recording of the surrogate whose
// physics has the effect.
#include "tools/export_model/cost.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/model/actuator/file/model_file.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/surrogate/surrogate.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tools/export_model/write_model.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::export_model {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
const fs::path kRig = fs::path(SINEW_SOURCE_DIR) / "robots/rig";
constexpr double kQuadratic = 0.3;  // N m s^2/rad^2: a third of a newton metre at 1 rad/s

actuator::RobotModel ModelWithEffect() {
  actuator::RobotModel robot = actuator::LoadRobotModel(kRig / "surrogate_model.yaml");
  actuator::JointModel& joint = robot.joints[0];
  joint.terms.push_back(actuator::MakeTerm("quadratic_viscous", joint.constants));
  joint.terms.back().linear[0].value = kQuadratic;
  joint.terms.back().declared = false;
  return robot;
}

// The surrogate with the effect, under control.
types::Run RecordSurrogate(double duration_s) {
  surrogate::RigParameters rig;
  rig.seed = 3;
  rig.effects = {{"quadratic_viscous", kQuadratic, 0.0}};
  surrogate::Surrogate plant(rig);
  tune::ClosedLoopConfig loop;
  loop.control =
      control::LoadControl(kRig / "control_pid_model.yaml", kRig / "surrogate_model.yaml").joints;
  loop.reference = reference::LoadReference(kRig / "reference_tuning.yaml").config;
  loop.pneumatics = pneumatics::LoadPneumatics(kRig / "pneumatics.yaml").joints;
  loop.duration_s = duration_s;
  loop.score_from_s = 2.5;
  std::vector<double> t, q, m, current, pressure, force, payload;
  loop.each_tick = [&](double time_s, const provider::PlantSensors& sensors) {
    t.push_back(time_s);
    q.push_back(sensors.position_rad[0]);
    m.push_back(sensors.motor_position_rad[0]);
    current.push_back(sensors.motor_current_A[0]);
    pressure.push_back(sensors.chamber_pressure_bar[0]);
    force.push_back(sensors.load_force_N[0]);
    payload.push_back(sensors.declared_payload_kg[0]);
  };
  tune::RunClosedLoop(loop, plant);
  const auto vector = [](const std::vector<double>& values) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  types::Run run;
  run.name = "surrogate";
  run.time_s = vector(t);
  run.signals = {{types::Signal::kPosition, vector(q)},
                 {types::Signal::kMotorPosition, vector(m)},
                 {types::Signal::kMotorCurrent, vector(current)},
                 {types::Signal::kChamberPressure, vector(pressure)},
                 {types::Signal::kLoadForce, vector(force)},
                 {types::Signal::kPayload, vector(payload)}};
  return run;
}

TEST(Costs, AreThoseOfAnEffectThatTheRecordingHas) {
  const actuator::RobotModel robot = ModelWithEffect();
  const std::vector<types::Run> runs{RecordSurrogate(8.0)};
  const std::vector<Dropped> dropped = DroppedBy(Format::kMjcf, robot);
  const Costs costs = CostsOf(dropped, robot, runs, identify::Resolve({}, runs), 0.5);
  EXPECT_EQ(costs.measure, Measure::kSimulatedPosition);
  ASSERT_EQ(costs.of.size(), dropped.size() + 1);
  EXPECT_EQ(costs.of.back().effect, "all");
  bool seen = false;
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    const Cost& cost = costs.of[i];
    EXPECT_EQ(cost.effect, dropped[i].effect);
    if (cost.effect != "quadratic_viscous") continue;
    seen = true;
    ASSERT_TRUE(cost.without && cost.with) << cost.why_not;
    EXPECT_GT(*cost.without, 1.4 * *cost.with);
  }
  EXPECT_TRUE(seen) << "MJCF has no friction that grows with the square of velocity";
  const Remarks remarks =
      MakeRemarks(Format::kMjcf, robot, {}, "model.yaml", dropped, costs, "held_out.mcap");
  std::string text;
  for (const std::string& remark : remarks) text += remark + "\n";
  EXPECT_THAT(text,
              HasSubstr("Not in MJCF: joint joint, quadratic_viscous (quadratic_Nm_s2_rad2 = 0.3); "
                        "simulated position wrong by "));
  EXPECT_THAT(text, HasSubstr("held_out.mcap"));
  EXPECT_THAT(text, HasSubstr("From outside: joint joint, load_force; here it is 0."));
}

TEST(Costs, OfOneJointAreNotThoseOfSeveral) {
  actuator::RobotModel robot = ModelWithEffect();
  robot.joints.push_back(robot.joints[0]);
  EXPECT_THROW(CostsOf({}, robot, {}, {}, 0.5), std::invalid_argument);
}

TEST(ExportModelCommand, WritesEveryFormatOfRigAndBiped) {
  const testing::TemporaryFolder folder;
  for (const char* robot : {"rig", "biped"}) {
    for (const std::string format : {"mjcf", "urdf", "sdf"}) {
      const fs::path out = folder.path() / (robot + ("." + format));
      const auto model = fs::path(SINEW_SOURCE_DIR) / "robots" / robot / "model.yaml";
      const testing::Finished done =
          testing::Run({kSinew, "export-model", model.string(), "--format", format, "--out",
                        out.string(), "--json"});
      ASSERT_EQ(done.exit_code, 0) << done.output << done.error;
      const auto json = nlohmann::json::parse(done.output);
      EXPECT_EQ(json["format"], format);
      EXPECT_EQ(json["dropped"].empty(), std::string(robot) == "biped" && format == "mjcf")
          << done.output << done.error;
      EXPECT_GT(fs::file_size(out), 500u);
    }
  }
}

TEST(ExportModelCommand, SaysWhatIsWrong) {
  const testing::TemporaryFolder folder;
  const std::string bare = folder.Write("bare.yaml",
                                        "schema: sinew-model/1\nname: x\njoints:\n  - name: j\n"
                                        "    kind: rotary\n    constants: {gear_ratio: 1}\n"
                                        "    terms: [{effect: viscous, viscous_Nm_s_rad: 1}]\n");
  const testing::Finished none = testing::Run({kSinew, "export-model", bare, "--format", "sdf"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.error, HasSubstr("names no urdf, expected one, or --urdf FILE"));
  const std::string biped = std::string(SINEW_SOURCE_DIR) + "/robots/biped/model.yaml";
  const testing::Finished on_feet =
      testing::Run({kSinew, "export-model", biped, "--format", "sdf", "--recording", bare});
  EXPECT_EQ(on_feet.exit_code, 2);
  EXPECT_THAT(on_feet.error, HasSubstr("expected one on a fixed base"));
}

}  // namespace
}  // namespace sinew::export_model
