// A corrected model goes unchanged into world and control. Oracle: a recording made by the world of
// the model itself; the surrogate with an effect.
#include "tools/verify/verify.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "components/model/actuator/file/model_file.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/plant/joint_body.h"
#include "sim/surrogate/surrogate.h"
#include "sim/world/file/world_file.h"
#include "tests/support/temporary_folder.h"

namespace sinew::verify {
namespace {

namespace fs = std::filesystem;
const fs::path kRig = fs::path(SINEW_SOURCE_DIR) / "robots/rig";
constexpr double kRate_Hz = 240.0;

actuator::RobotModel RigModel() { return actuator::LoadRobotModel(kRig / "surrogate_model.yaml"); }

// Small and physical: torques of some mN m to some tens in this motion.
double SmallValue(effects::Dimension dimension) {
  switch (dimension) {
    case effects::Dimension::kInertiaTimeSquared:
      return 1e-6;  // resonance beyond 50 Hz
    case effects::Dimension::kInertiaTime:
      return 1e-5;
    default:
      return 1e-3;
  }
}

actuator::Term AddedTerm(const std::string& name, const effects::JointConstants& constants) {
  actuator::Term term = actuator::MakeTerm(name, constants);
  term.declared = false;
  const effects::EffectInfo& info = term.effect->info();
  for (std::size_t i = 0; i < term.linear.size(); ++i) {
    const effects::ParameterInfo& parameter = info.linear[i];
    term.linear[i].value =
        std::clamp(SmallValue(parameter.dimension), parameter.lower, parameter.upper);
  }
  return term;
}

tune::ClosedLoopConfig Loop(const fs::path& model) {
  tune::ClosedLoopConfig loop;
  loop.control = control::LoadControl(kRig / "control_pid_model.yaml", model).joints;
  loop.reference = reference::LoadReference(kRig / "reference_benchmark.yaml").config;
  loop.pneumatics = pneumatics::LoadPneumatics(kRig / "pneumatics.yaml").joints;
  loop.duration_s = 4.0;
  loop.score_from_s = 2.5;
  return loop;
}

TEST(Verify, EveryEffectGoesUnchangedFromTheFileIntoWorldAndControl) {
  const testing::TemporaryFolder folder;
  const fs::path path = folder.path() / "model.yaml";
  for (const std::string& name : effects::EffectNames()) {
    SCOPED_TRACE(name);
    actuator::RobotModel robot = RigModel();
    if (robot.joints[0].Find(name) >= 0) continue;
    // A drive in volts, or inertia of everything, would be a second one.
    if (name == "drive_voltage" || name == "inertia") continue;
    if (!(robot.joints[0].constants.gas_volume_m3 > 0.0)) {
      robot.joints[0].constants.gas_volume_m3 = 2e-3;  // the gas effects ask for it
    }
    robot.joints[0].terms.push_back(AddedTerm(name, robot.joints[0].constants));
    actuator::SaveRobotModel(path, robot);
    const actuator::RobotModel read = actuator::LoadRobotModel(path);
    ASSERT_GE(read.joints[0].Find(name), 0);
    EXPECT_FALSE(read.joints[0].terms.back().declared);

    const world::WorldFile file = world::LoadWorldFile(kRig / "world.yaml", path);
    const std::unique_ptr<provider::SimulatedPlant> world = world::MakeWorld(file, path);
    tune::ClosedLoopConfig loop = Loop(path);
    loop.pneumatics.clear();
    loop.duration_s = 1.5;
    loop.score_from_s = 0.6;
    const tune::ClosedLoopScore score = tune::RunClosedLoop(loop, *world);
    EXPECT_FALSE(score.faulted);
    EXPECT_TRUE(std::isfinite(score.mse_rad2));
    EXPECT_GT(score.torque_rms_Nm, 0.0);
    EXPECT_LT(score.worst_rad, 0.3) << "the joint was lost";
  }
}

// The surrogate's own motion under control, as a recording.
types::Run Record(const std::string& effect, double size, std::uint64_t seed) {
  surrogate::RigParameters rig;
  rig.seed = seed;
  if (!effect.empty()) rig.effects = {{effect, size, 0.0}};
  surrogate::Surrogate plant(rig);
  tune::ClosedLoopConfig loop = Loop(kRig / "surrogate_model.yaml");
  loop.reference = reference::LoadReference(kRig / "reference_tuning.yaml").config;
  loop.duration_s = 20.0;
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

TEST(Verify, TheWorldOfTheRightModelFollowsTheRecordingBetter) {
  actuator::RobotModel wrong = RigModel(), right = RigModel();
  right.joints[0].terms.push_back(AddedTerm("quadratic_viscous", right.joints[0].constants));
  right.joints[0].terms.back().linear[0].value = 0.3;
  const std::vector<types::Run> runs{Record("quadratic_viscous", 0.3, 3)};
  const identify::ProcessingOptions processing = identify::Resolve({}, runs);
  const free_run::FreeRunResult result = FollowRecordings(runs, wrong, right, processing, 0.5);
  ASSERT_TRUE(result.errors) << result.why_not;
  EXPECT_EQ(result.errors->method, free_run::Method::kHorizons);
  EXPECT_GT(result.errors->models[1].runs[0].pieces, 30);
  EXPECT_LT(result.errors->models[1].rms, 0.7 * result.errors->models[0].rms);
  // The world and the joint alone are the same physics.
  const free_run::FreeRunResult alone =
      free_run::Compare(runs, {wrong.joints[0], right.joints[0]}, processing, plant::JointAlone());
  ASSERT_TRUE(alone.errors);
  EXPECT_NEAR(result.errors->models[1].rms, alone.errors->models[1].rms,
              0.1 * alone.errors->models[1].rms);

  const Names names{.before = "a", .after = "b", .added = {"quadratic_viscous"}, .effects = "none"};
  const report::Section section = MakeSection(names, types::JointKind::kRevolute, &result, {});
  report::CheckSection(section);
  ASSERT_EQ(section.comparisons.size(), 2u);
  EXPECT_TRUE(*section.comparisons[0].met);
  EXPECT_THAT(FormatJson(names, types::JointKind::kRevolute, &result, {}),
              ::testing::HasSubstr("\"horizons\""));
}

TEST(Verify, ControlFollowsBetterWithTheEffectInItsModel) {
  const testing::TemporaryFolder folder;
  actuator::RobotModel right = RigModel();
  right.joints[0].terms.push_back(AddedTerm("quadratic_viscous", right.joints[0].constants));
  right.joints[0].terms.back().linear[0].value = 0.5;
  actuator::SaveRobotModel(folder.path() / "right.yaml", right);
  TrackingSetup setup;
  setup.before = Loop(kRig / "surrogate_model.yaml");
  setup.after = Loop(folder.path() / "right.yaml");
  setup.before.duration_s = setup.after.duration_s = 10.0;
  setup.rig.effects = {{"quadratic_viscous", 0.5, 0.0}};
  const TrackingRun run = Track(setup, 5);
  EXPECT_LT(run.after.mse_rad2, 0.8 * run.before.mse_rad2);
  const Names names{.before = "a", .after = "b", .added = {}, .effects = "quadratic_viscous=0.5"};
  const report::Section section = MakeSection(names, types::JointKind::kRevolute, nullptr, {run});
  report::CheckSection(section);
  EXPECT_TRUE(*section.comparisons[0].met);
}

TEST(Verify, RefusesRobotsOfSeveralJointsAndModelsOfOtherJoints) {
  actuator::RobotModel robot = RigModel();
  const std::vector<types::Run> none;
  actuator::RobotModel other = robot;
  other.joints[0].name = "elbow";
  EXPECT_THROW(static_cast<void>(FollowRecordings(none, other, robot, {}, 0.5)),
               std::invalid_argument);
  robot.joints.push_back(robot.joints[0]);
  EXPECT_THROW(static_cast<void>(InWorld(robot)), std::invalid_argument);
}

TEST(Verify, WithoutAddedTakesAwayWhatCloseLoopAdded) {
  actuator::RobotModel robot = RigModel();
  const std::size_t declared = robot.joints[0].terms.size();
  robot.joints[0].terms.push_back(AddedTerm("stribeck", robot.joints[0].constants));
  EXPECT_EQ(WithoutAdded(robot).joints[0].terms.size(), declared);
}

}  // namespace
}  // namespace sinew::verify
