#include "sim/world/world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>

#include "components/base/types/control_mode.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"
#include "sim/plant/single_joint.h"
#include "sim/world/file/world_file.h"
#include "tests/support/skip.h"

namespace sinew::world {
namespace {

using provider::PlantCommand;
using provider::PlantSensors;
using ::testing::HasSubstr;

constexpr double kPeriod_s = 1.0 / 240.0;

WorldFile Rig() { return LoadWorldFile(SINEW_SOURCE_DIR "/robots/rig/world.yaml"); }

actuator::Term MakeTerm(const char* effect, double value, const actuator::JointModel& joint) {
  actuator::Term term = actuator::MakeTerm(effect, joint.constants);
  term.linear[0].value = value;
  return term;
}

PlantCommand Torque(double motor_torque_Nm) {
  PlantCommand command;
  command.mode[0] = types::ControlMode::kTorque;
  command.motor_torque_Nm[0] = motor_torque_Nm;
  return command;
}

TEST(World, StartsAtRestWhereItsConfigurationPutsIt) {
  World world(Rig().config);
  PlantSensors sensors;
  world.Reset(&sensors);
  EXPECT_NEAR(sensors.position_rad[0], -1.2, M_PI / 16384.0);
  EXPECT_EQ(sensors.velocity_rad_s[0], 0.0);
  EXPECT_NEAR(sensors.motor_position_rad[0], -120.0, M_PI / 16384.0);
  EXPECT_NEAR(sensors.reservoir_pressure_bar[0], 6.0, 1e-9);
  EXPECT_TRUE(sensors.valid[0]);
  EXPECT_EQ(world.joint_count(), 1);
  EXPECT_FALSE(world.prismatic(0));
}

// The URDF alone: a model without inertia and gravity leaves both to Bullet.
TEST(World, SwingsTheUrdfsLinkWithThePeriodOfAPendulum) {
  WorldConfig config = Rig().config;
  actuator::JointModel& joint = config.model.joints[0];
  joint.backlash_rad = 0.0;
  joint.terms.clear();
  joint.terms.push_back(MakeTerm("drive_current", 0.77, joint));
  config.joints[0] = {};
  config.joints[0].position_rad = -M_PI / 2.0 + 0.01;
  World world(config);
  PlantSensors sensors;
  double last = -1.0, period = 0.0, before = 0.01;
  for (int k = 1; k < 2400; ++k) {
    world.Step({}, kPeriod_s, &sensors);
    const double after = world.position_rad(0) + M_PI / 2.0;
    if (before < 0.0 && after >= 0.0) {
      const double t = (k + before / (before - after)) * kPeriod_s;
      if (last >= 0.0) period = t - last;
      last = t;
    }
    before = after;
  }
  const double mass = 0.34711, arm = 0.1703577, inertia = 3.1662e-3 + mass * arm * arm;
  // Linear interpolation over 1/240 s at 6.6 rad/s: (w dt)^2 / 8 of a period's share, 1e-5.
  EXPECT_NEAR(period, 2.0 * M_PI * std::sqrt(inertia / (mass * 9.81 * arm)), 1e-4);
  EXPECT_NEAR(inertia, 0.01324, 1e-5);
  EXPECT_NEAR(mass * 9.81 * arm, 0.58, 1e-4);
}

// Two pendulums on parallel axes, the second following the first: (I1 + k^2 I2) q'' = - m g r (cos
// q
// + k cos(k q + o)). The energy of the symmetric step does not drift: its error is of the order of
// (h w)^2, with w < 20 rad/s and h = 1e-4 s.
TEST(World, AJointThatMimicsTheModelsAddsItsInertiaAndWeight) {
  constexpr double kMass_kg = 0.8, kArm_m = 0.25, kInertia = 0.01 + kMass_kg * kArm_m * kArm_m;
  const auto robot = [](const std::string& mimic, const std::string& type) {
    std::string text = "<robot name='r'><link name='base'/>";
    for (const std::string name : {"joint", "follower"}) {
      text +=
          "<link name='l" + name +
          "'><inertial><origin xyz='0.25 0 0'/><mass value='0.8'/>"
          "<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>"
          "<joint name='" +
          name + "' type='" + type + "'><parent link='base'/><child link='l" + name +
          "'/><axis xyz='0 -1 0'/>" + (name == "follower" ? mimic : "") + "</joint>";
    }
    return arm::ParseUrdf(text + "</robot>", "r.urdf");
  };
  for (const auto& [k, o] :
       {std::pair{1.0, 0.0}, {-1.0, 0.0}, {2.5, 0.3}, {-0.4, -1.1}, {0.0, 0.7}}) {
    WorldConfig config = Rig().config;
    config.chain = robot("<mimic joint='joint' multiplier='" + std::to_string(k) + "' offset='" +
                             std::to_string(o) + "'/>",
                         "continuous");
    actuator::JointModel& joint = config.model.joints[0];
    joint.backlash_rad = 0.0;
    joint.terms.clear();
    joint.terms.push_back(MakeTerm("drive_current", 0.77, joint));
    config.joints[0] = {};
    config.joints[0].position_rad = 0.2;
    World world(config);
    ASSERT_EQ(world.joint_count(), 1);
    const auto energy_J = [&, k = k, o = o] {
      const double q = world.position_rad(0), v = world.velocity_rad_s(0);
      return 0.5 * kInertia * (1.0 + k * k) * v * v +
             kMass_kg * 9.81 * kArm_m * (std::sin(q) + std::sin(k * q + o));
    };
    const double start_J = energy_J();
    PlantSensors sensors;
    double fastest_rad_s = 0.0;
    for (int step = 0; step < 2400; ++step) {
      world.Step({}, kPeriod_s, &sensors);
      EXPECT_NEAR(energy_J(), start_J, 1e-5) << "multiplier " << k << ", step " << step;
      fastest_rad_s = std::max(fastest_rad_s, std::abs(world.velocity_rad_s(0)));
    }
    if (k != -1.0) EXPECT_GT(fastest_rad_s, 1.0);

    joint.terms.push_back(MakeTerm("link_inertia", kInertia, joint));
    EXPECT_THROW(World{config}, std::invalid_argument) << "whose inertia is it?";
    joint.terms.pop_back();
    joint.name = "follower";
    try {
      World{config};
      FAIL() << "a model of a joint that follows another";
    } catch (const std::invalid_argument& error) {
      EXPECT_STREQ(error.what(),
                   "joint 'follower' mimics 'joint' in the URDF and moves with it, expected no "
                   "model of it");
    }
  }
}

// With its own gravity and inertia terms the model gives the same motion as the URDF they describe.
TEST(World, GivesTheSameMotionFromUrdfAndFromModel) {
  WorldConfig by_urdf = Rig().config;
  actuator::JointModel& joint = by_urdf.model.joints[0];
  joint.backlash_rad = 0.0;
  joint.terms.clear();
  joint.terms.push_back(MakeTerm("drive_current", 0.77, joint));
  joint.terms.push_back(MakeTerm("viscous", 0.01, joint));
  by_urdf.joints[0] = {};
  WorldConfig by_model = by_urdf;
  const double mass = 0.34711, arm = 0.1703577;
  by_model.model.joints[0].terms.push_back(
      MakeTerm("link_inertia", 3.1662e-3 + mass * arm * arm, joint));
  by_model.model.joints[0].terms.push_back(MakeTerm("gravity", mass * 9.81 * arm, joint));
  World first(by_urdf), second(by_model);
  PlantSensors sensors;
  for (int k = 0; k < 480; ++k) {
    first.Step(Torque(0.002), kPeriod_s, &sensors);
    second.Step(Torque(0.002), kPeriod_s, &sensors);
  }
  EXPECT_NEAR(first.position_rad(0), second.position_rad(0), 1e-9);
  EXPECT_GT(std::abs(first.position_rad(0)), 0.01);
}

// Bullet in between changes nothing: the whole rig, sliding both ways, against the plant on its
// own.
TEST(World, MovesTheRigAsTheActuatorPlantAloneDoes) {
  WorldConfig config = Rig().config;
  config.joints[0] = {};
  config.joints[0].declared_payload_kg = 0.5;
  config.chain.bodies[0].lower = -(config.chain.bodies[0].upper = 100.0);
  World world(config);
  plant::SingleJoint alone(config.model.joints[0], {});
  alone.plant().SetLoad(0.0, 0.5);
  PlantSensors sensors;
  int forwards = 0, backwards = 0;
  for (int k = 0; k < 960; ++k) {
    const double torque_Nm = 0.04 * std::sin(0.03 * k);
    world.Step(Torque(torque_Nm), kPeriod_s, &sensors);
    alone.plant().SetCommand({.mode = types::ControlMode::kTorque, .motor_torque_Nm = torque_Nm});
    for (int i = 0; i < 42; ++i) alone.Step(kPeriod_s / 42.0);
    forwards += world.velocity_rad_s(0) > 0.01;
    backwards += world.velocity_rad_s(0) < -0.01;
    ASSERT_NEAR(world.position_rad(0), alone.position_rad(), 1e-7)
        << k;  // impacts amplify rounding
  }
  EXPECT_GT(forwards, 100);
  EXPECT_GT(backwards, 100);
}

TEST(World, HoldsStillWithTheMotorOff) {
  World world(Rig().config);
  PlantSensors sensors;
  for (int k = 0; k < 2400; ++k) world.Step({}, kPeriod_s, &sensors);
  const double rest = world.position_rad(0);
  for (int k = 0; k < 240; ++k) world.Step({}, kPeriod_s, &sensors);
  EXPECT_EQ(world.position_rad(0), rest);  // friction 0.22 Nm holds it near hanging
}

TEST(World, MovesToAPositionAndFillsTheChamber) {
  World world(Rig().config);
  PlantSensors sensors;
  PlantCommand command;
  command.mode[0] = types::ControlMode::kPosition;
  command.position_rad[0] = 0.2;
  command.valve_open[0] = true;
  for (int k = 0; k < 480; ++k) world.Step(command, kPeriod_s, &sensors);
  EXPECT_NEAR(sensors.motor_position_rad[0], 20.0, 0.1);
  EXPECT_NEAR(sensors.position_rad[0], 0.2, 0.024);
  EXPECT_NEAR(sensors.chamber_pressure_bar[0], sensors.reservoir_pressure_bar[0], 0.01);
  EXPECT_GT(sensors.chamber_pressure_bar[0], 5.0);
  EXPECT_TRUE(sensors.valve_open[0]);
}

TEST(World, FeelsTheHandAndAPayload) {
  WorldConfig config = Rig().config;
  World alone(config), pushed(config), loaded(config);
  PlantSensors sensors;
  PlantCommand command;
  command.mode[0] = types::ControlMode::kPosition;
  pushed.Disturb({.hand_force_N = {10.0}});
  loaded.Disturb({.extra_payload_kg = {1.0}});
  for (int k = 0; k < 960; ++k) {
    alone.Step(command, kPeriod_s, &sensors);
    loaded.Step(command, kPeriod_s, &sensors);
    EXPECT_EQ(sensors.declared_payload_kg[0], 0.0);
    pushed.Step(command, kPeriod_s, &sensors);
  }
  EXPECT_EQ(sensors.load_force_N[0], 10.0);
  // Held by the motor at the lower teeth: the torque grows by F l and by m g l cos q, the angle is
  // within the play of 0. Friction (0.22 Nm) may carry part of it on either side.
  const double base = alone.plant(0).drive_torque_Nm();
  EXPECT_NEAR(pushed.plant(0).drive_torque_Nm() - base, 3.0, 0.45);
  EXPECT_NEAR(loaded.plant(0).drive_torque_Nm() - base, 9.81 * 0.3, 0.45);
}

TEST(World, RepeatsBitByBit) {
  const WorldFile file = Rig();
  World first(file.config), second(file.config);
  PlantSensors a, b;
  for (int k = 0; k < 480; ++k) {
    PlantCommand command = Torque(0.05 * std::sin(0.05 * k));
    command.valve_open[0] = k % 100 < 50;
    first.Step(command, kPeriod_s, &a);
    second.Step(command, kPeriod_s, &b);
    ASSERT_EQ(0, std::memcmp(a.position_rad.data(), b.position_rad.data(), sizeof(a.position_rad)));
    ASSERT_EQ(a.motor_velocity_rad_s, b.motor_velocity_rad_s);
    ASSERT_EQ(a.chamber_pressure_bar, b.chamber_pressure_bar);
  }
  // And again after Reset.
  first.Reset(&a);
  World third(file.config);
  for (int k = 0; k < 240; ++k) {
    first.Step(Torque(0.03), kPeriod_s, &a);
    third.Step(Torque(0.03), kPeriod_s, &b);
  }
  EXPECT_EQ(a.position_rad, b.position_rad);
}

TEST(World, StopsAtTheLimitsOfTheUrdf) {
  World world(Rig().config);
  PlantSensors sensors;
  for (int k = 0; k < 960; ++k) world.Step(Torque(0.2), kPeriod_s, &sensors);
  EXPECT_NEAR(world.position_rad(0), 2.2, 1e-3);
  EXPECT_EQ(world.velocity_rad_s(0), 0.0);
  for (int k = 0; k < 240; ++k) world.Step(Torque(-0.2), kPeriod_s, &sensors);
  EXPECT_LT(world.position_rad(0), 2.0);
}

TEST(World, MovesTheLinearAxisByForceOverMass) {
  WorldConfig config = LoadWorldFile(SINEW_SOURCE_DIR "/robots/emps/world.yaml").config;
  auto& terms = config.model.joints[0].terms;
  std::erase_if(
      terms, [](const auto& term) { return term.effect->info().role == effects::Role::kPassive; });
  config.model.joints[0].terms[1].linear[0].value = 50.0;  // not the URDF's 95 kg
  World world(config);
  EXPECT_TRUE(world.prismatic(0));
  PlantSensors sensors;
  for (int k = 0; k < 120; ++k) world.Step(Torque(20.0), kPeriod_s, &sensors);
  EXPECT_NEAR(world.velocity_rad_s(0), 20.0 / 50.0 * 0.5, 1e-12);
  EXPECT_NEAR(world.position_rad(0), 0.5 * 20.0 / 50.0 * 0.25, 1e-12);
  EXPECT_NEAR(sensors.drive_voltage_V[0], 20.0 / 35.1506518825, 1e-12);
  EXPECT_EQ(sensors.motor_current_A[0], 0.0);
}

TEST(World, LoadsAModelWithAnAddedEffectAsItIs) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("sinew_world_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const std::string robot : {"rig", "emps"}) {
    const std::string from = SINEW_SOURCE_DIR "/robots/" + robot;
    actuator::ModelFile file = actuator::LoadModelFile(from + "/model.yaml");
    actuator::JointModel& joint = file.robot.joints[0];
    joint.terms.push_back(MakeTerm("direction_dependent_viscous", 0.1, joint));
    joint.terms.push_back(MakeTerm("flexible_link", 1e-4, joint));
    joint.terms.back().declared = false;
    joint.history.push_back({"2026-01-01T00:00:00Z", "flexible_link", "x.csv", ""});
    actuator::SaveModelFile(folder / "model.yaml", file);
    const WorldFile loaded = LoadWorldFile(from + "/world.yaml", folder / "model.yaml");
    World world(loaded.config);
    PlantSensors sensors;
    for (int k = 0; k < 240; ++k) {
      world.Step(Torque(robot == "rig" ? 0.03 : 30.0), kPeriod_s, &sensors);
    }
    EXPECT_FALSE(sensors.fault);
    EXPECT_NE(sensors.velocity_rad_s[0], 0.0);
  }
  std::filesystem::remove_all(folder);
}

TEST(World, TakesAnArmOfSevenJoints) {
  const std::filesystem::path urdf =
      SINEW_SHARED_DIR "/data/kuka_lwr4_inverse_dynamics/kuka_lwr4.urdf";
  SKIP_WITHOUT_DATA(urdf);
  WorldConfig config;
  config.chain = arm::ParseUrdf(config::ReadFile(urdf), urdf.string());
  for (const arm::Body& body : config.chain.bodies) {
    if (!body.moves) continue;
    actuator::JointModel joint;
    joint.name = body.joint_name;
    joint.constants.torque_constant_Nm_A = 0.1;
    joint.constants.gear_ratio = 100.0;
    joint.terms.push_back(MakeTerm("drive_current", 1.0, joint));
    joint.terms.push_back(MakeTerm("rotor_inertia", 0.3, joint));
    joint.terms.push_back(MakeTerm("coulomb", 100.0, joint));
    config.model.joints.push_back(joint);
  }
  World world(config);
  PlantSensors sensors;
  for (int k = 0; k < 120; ++k) world.Step({}, kPeriod_s, &sensors);
  for (int j = 0; j < 7; ++j) EXPECT_EQ(world.position_rad(j), 0.0) << j;  // friction holds the arm
  for (int j = 0; j < 7; ++j) {
    auto& terms = config.model.joints[static_cast<std::size_t>(j)].terms;
    terms.back().linear[0].value = 0.1;
  }
  World loose(config);
  for (int k = 0; k < 240; ++k) loose.Step({}, kPeriod_s, &sensors);
  EXPECT_FALSE(sensors.fault);
  double fastest = 0.0;
  for (int j = 0; j < 7; ++j) fastest = std::max(fastest, std::abs(loose.velocity_rad_s(j)));
  EXPECT_LT(fastest, 50.0);
}

TEST(World, RefusesModelsThatDoNotFitTheUrdf) {
  const WorldFile file = Rig();
  const auto error_of = [](const WorldConfig& config) -> std::string {
    try {
      World world(config);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  };
  WorldConfig config = file.config;
  config.model.joints[0].name = "elbow";
  EXPECT_THAT(error_of(config), ::testing::AllOf(HasSubstr("'elbow'"), HasSubstr("joint")));
  config = file.config;
  config.model.joints.clear();
  config.joints.clear();
  EXPECT_THAT(error_of(config), HasSubstr("has no model"));
  config = file.config;
  config.model.joints[0].kind = types::JointKind::kPrismatic;
  EXPECT_THAT(error_of(config), HasSubstr("revolute"));
  config = file.config;
  config.joints[0].position_rad = 3.0;
  EXPECT_THAT(error_of(config), HasSubstr("limits"));
  config = file.config;
  config.substep_s = 0.0;
  EXPECT_THAT(error_of(config), HasSubstr("substep_s"));
}

TEST(World, RefusesPassiveJoints) {
  WorldConfig config = Rig().config;
  config.chain.bodies[0].passive = arm::Passive{.stiffness_Nm_rad = 1.0, .damping_Nms_rad = 0.1};
  const auto error_of = [&]() -> std::string {
    try {
      World world(config);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of(), ::testing::AllOf(HasSubstr("'joint'"), HasSubstr("passive")));
  config.model.joints.clear();
  config.joints.clear();
  EXPECT_THAT(error_of(), HasSubstr("floating base"));
}

TEST(World, ReportsAFaultWhenItDiverges) {
  WorldConfig config = Rig().config;
  actuator::JointModel& joint = config.model.joints[0];
  joint.terms[static_cast<std::size_t>(joint.Find("motor_viscous"))].linear[0].value = -1e6;
  config.chain.bodies[0].upper = -(config.chain.bodies[0].lower = -1e300);
  World world(config);
  PlantSensors sensors;
  for (int k = 0; k < 240 && !sensors.fault; ++k) world.Step(Torque(0.1), kPeriod_s, &sensors);
  EXPECT_TRUE(sensors.fault);
  EXPECT_THAT(sensors.message, HasSubstr("diverged"));
}

TEST(World, ADisturbanceActsUntilTheNextOneAndEndsWithReset) {
  World world(Rig().config);
  PlantSensors sensors;
  world.Disturb({.hand_force_N = {10.0}});
  world.Step({}, kPeriod_s, &sensors);
  world.Step({}, kPeriod_s, &sensors);
  EXPECT_EQ(sensors.load_force_N[0], 10.0);
  world.Disturb({.hand_force_N = {4.0}, .extra_payload_kg = {-1.0}});
  world.Step({}, kPeriod_s, &sensors);
  EXPECT_EQ(sensors.load_force_N[0], 4.0);
  world.Reset(&sensors);
  world.Step({}, kPeriod_s, &sensors);
  EXPECT_EQ(sensors.load_force_N[0], 0.0);
}

TEST(World, TakesNonFiniteCommandsAsNone) {
  World world(Rig().config);
  PlantSensors sensors;
  PlantCommand command = Torque(std::numeric_limits<double>::quiet_NaN());
  world.Disturb({.hand_force_N = {std::numeric_limits<double>::infinity()},
                 .extra_payload_kg = {std::numeric_limits<double>::quiet_NaN()}});
  for (int k = 0; k < 10; ++k) world.Step(command, kPeriod_s, &sensors);
  EXPECT_FALSE(sensors.fault);
  EXPECT_EQ(sensors.motor_current_A[0], 0.0);
}

TEST(World, RunsFarFasterThanTheRig) {
  World world(Rig().config);
  PlantSensors sensors;
  const std::clock_t start = std::clock();  // processor time: other programs do not count
  constexpr int kSeconds = 20;
  for (int k = 0; k < 240 * kSeconds; ++k) {
    world.Step(Torque(0.03 * std::sin(0.01 * k)), kPeriod_s, &sensors);
  }
  const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  std::printf("world: %.0f times real time\n", kSeconds / took);
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_GT(kSeconds / took, 50.0);
#endif
}

class WorldFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("sinew_world_file_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    for (const char* name : {"model.yaml", "rig.urdf"}) {
      std::filesystem::copy_file(std::filesystem::path(SINEW_SOURCE_DIR "/robots/rig") / name,
                                 folder_ / name);
    }
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string ErrorOf(const std::string& text) {
    std::ofstream(folder_ / "world.yaml") << text;
    try {
      const WorldFile file = LoadWorldFile(folder_ / "world.yaml");
      MakeWorld(file, folder_ / "world.yaml");
    } catch (const UsageError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      return what;
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

TEST_F(WorldFileTest, ReportsAnErrorInOneLine) {
  const std::string head = "schema: sinew-world/1\nurdf: rig.urdf\nmodel: model.yaml\n";
  EXPECT_EQ(ErrorOf(head), "no error");
  EXPECT_THAT(ErrorOf("schema: sinew-world/1\nurdf: no.urdf\nmodel: model.yaml\n"),
              ::testing::AllOf(HasSubstr("world.yaml:2"), HasSubstr("no.urdf")));
  EXPECT_THAT(ErrorOf("schema: sinew-world/1\nurdf: rig.urdf\n"), HasSubstr("model"));
  EXPECT_THAT(ErrorOf(head + "speed: 1\n"), HasSubstr("'speed'"));
  EXPECT_THAT(ErrorOf(head + "joints:\n  - {name: elbow}\n"),
              ::testing::AllOf(HasSubstr(":5"), HasSubstr("elbow"), HasSubstr("joint")));
  EXPECT_THAT(ErrorOf(head + "joints:\n  - {name: joint, position_deg: 3}\n"),
              HasSubstr("position_rad"));
  EXPECT_THAT(ErrorOf(head + "joints:\n  - {name: joint, pneumatics: {chamber_volume_l: 1}}\n"),
              HasSubstr("chamber_volume"));
  EXPECT_THAT(ErrorOf(head + "joints:\n  - {name: joint, declared_payload_kg: .nan}\n"),
              HasSubstr("declared_payload_kg"));
  EXPECT_THAT(ErrorOf(head + "joints:\n  - {name: joint, position_rad: 3}\n"), HasSubstr("limits"));
  EXPECT_THAT(ErrorOf(head + "substep_s: 1.0e-3\n"), HasSubstr("free play"));
  std::ofstream(folder_ / "rig.urdf") << "<robot name='r'><link name='a'>";
  EXPECT_THAT(ErrorOf(head), ::testing::AllOf(HasSubstr("rig.urdf:"), HasSubstr("no valid XML")));
}

// The rig's drive on a floating base: a box that swings an arm.
TEST_F(WorldFileTest, ReadsAFloatingBase) {
  const std::string head =
      "schema: sinew-world/1\nurdf: box.urdf\nmodel: box_model.yaml\nfloating_base:\n";
  std::ofstream(folder_ / "box.urdf")
      << "<robot name='box'><link name='base'/><link name='box'><inertial><mass value='2'/>"
         "<inertia ixx='0.01' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link>"
         "<joint name='mount' type='fixed'><parent link='base'/><child link='box'/></joint>"
         "<link name='arm'><inertial><origin xyz='0 0 0.05'/><mass value='0.1'/>"
         "<inertia ixx='1e-4' ixy='0' ixz='0' iyy='1e-4' iyz='0' izz='1e-4'/></inertial></link>"
         "<joint name='joint' type='continuous'><parent link='box'/><child link='arm'/>"
         "<axis xyz='0 1 0'/></joint></robot>\n";
  actuator::ModelFile model = actuator::LoadModelFile(SINEW_SOURCE_DIR "/robots/rig/model.yaml");
  actuator::JointModel& joint = model.robot.joints[0];
  std::erase_if(joint.terms, [](const actuator::Term& term) {
    const std::string& name = term.effect->info().name;
    return name != "drive_current" && name != "rotor_inertia";
  });
  joint.backlash_rad = 0.0;
  actuator::SaveModelFile(folder_ / "box_model.yaml", model);
  const std::string corners =
      "  contact_points:\n"
      "    - {link: box, point_m: [0.1, 0.1, -0.1]}\n    - {link: box, point_m: [0.1, -0.1, "
      "-0.1]}\n"
      "    - {link: box, point_m: [-0.1, 0.1, -0.1]}\n"
      "    - {link: box, point_m: [-0.1, -0.1, -0.1]}\n";
  EXPECT_EQ(ErrorOf(head + "  contacts: [arm]\n"), "no error");
  EXPECT_EQ(ErrorOf(head + corners + "  imu: box\n  ground: {friction: 0.5, static_load_N: 5}\n"),
            "no error");
  const WorldFile file = LoadWorldFile(folder_ / "world.yaml");
  ASSERT_TRUE(file.floating_base);
  EXPECT_EQ(file.floating_base->contacts.size(), 4u);
  EXPECT_EQ(file.floating_base->ground.friction, 0.5);
  EXPECT_EQ(file.floating_base->ground.static_sink_m, GroundConfig{}.static_sink_m);
  EXPECT_EQ(file.config.substep_s, kRobotSubstep_s);
  const auto robot = MakeWorld(file, folder_ / "world.yaml");
  ASSERT_NE(robot->body_sensors(), nullptr);
  const auto& force_N = robot->body_sensors()->foot_force_N;
  EXPECT_NEAR(force_N[0] + force_N[1] + force_N[2] + force_N[3], 2.1 * 9.81, 1e-9);
  EXPECT_TRUE(robot->body_sensors()->foot_valid[3]);
  EXPECT_FALSE(robot->body_sensors()->foot_valid[4]);
  EXPECT_NE(robot->body_truth(), nullptr);

  EXPECT_EQ(ErrorOf(head + corners +
                    "  imu: box\n  start: at_rest\n  imu_errors: {part: mpu6050, rate: "
                    "{bias_rad_s: 0.1}}\n  foot_errors: {step_N: 0.5}\n"),
            "no error");
  const WorldFile sensors = LoadWorldFile(folder_ / "world.yaml");
  EXPECT_EQ(sensors.floating_base->start, StartPose::kAtRest);
  EXPECT_EQ(sensors.floating_base->imu_errors.force.bias, kMpu6050.force.bias);
  EXPECT_EQ(sensors.floating_base->imu_errors.rate.bias, 0.1);
  EXPECT_EQ(sensors.floating_base->imu_errors.rate.step, kMpu6050.rate.step);
  EXPECT_EQ(sensors.floating_base->foot_errors.step, 0.5);
  EXPECT_EQ(file.floating_base->imu_errors.force.bias, 0.0) << "ideal where nothing is said";
  EXPECT_THAT(ErrorOf(head + corners + "  imu_errors: {part: mpu9250}\n"), HasSubstr("mpu6050"));
  EXPECT_THAT(ErrorOf(head + corners + "  imu_errors: {force: {bias_N: 1}}\n"),
              HasSubstr("bias_N"));
  EXPECT_THAT(ErrorOf(head + corners + "  foot_errors: {noise_density_N_sqrtHz: 1}\n"),
              HasSubstr("needs a bandwidth"));
  EXPECT_THAT(ErrorOf(head + corners + "  base_height_m: 1.0\n  start: at_rest\n"),
              HasSubstr("at rest"));

  EXPECT_THAT(ErrorOf(head + "  contacts: [hand]\n"), HasSubstr("'hand'"));
  EXPECT_THAT(ErrorOf(head + "  contact_points:\n    - {link: box, point_m: [0, 1]}\n"),
              ::testing::AllOf(HasSubstr("world.yaml:6"), HasSubstr("point_m")));
  EXPECT_THAT(ErrorOf(head + corners + "  imu: arm\n"), HasSubstr("moves"));
  EXPECT_THAT(ErrorOf(head + corners + "  ground: {restitution: 1.0}\n"),
              ::testing::AllOf(HasSubstr("world.yaml:"), HasSubstr("restitution")));
  EXPECT_THAT(ErrorOf(head + corners + "  ground: {mu: 1.0}\n"),
              HasSubstr("'floating_base.ground"));
  EXPECT_THAT(ErrorOf(head + corners + "  height_m: 1.0\n"), HasSubstr("height_m"));
  EXPECT_THAT(ErrorOf(head + "  base_height_m: 1.0\n"), "no error");
  EXPECT_THAT(ErrorOf(head + "  imu: box\n"), HasSubstr("base_height_m"));
}

TEST_F(WorldFileTest, TakesALaboratorysRigJsonAsTheModel) {
  const std::filesystem::path path = SINEW_SHARED_DIR "/data/rig_examples/clean/rig.json";
  SKIP_WITHOUT_DATA(path);
  const WorldFile file = LoadWorldFile(SINEW_SOURCE_DIR "/robots/rig/world.yaml", path);
  World world(file.config);
  EXPECT_EQ(world.joint_count(), 1);
}

}  // namespace
}  // namespace sinew::world
