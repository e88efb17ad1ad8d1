#include "components/robot/provider/provider_cycle.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::provider {
namespace {

using types::FaultCause;

using types::ControlMode;
using types::OperatorAction;
using types::Origin;
using types::RobotState;

constexpr std::uint64_t kCycleSession = 42;
constexpr int kCycleJoints = 2;
constexpr double kRate_Hz = 240.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

CycleConfig Config(GuardConfig guard = {}) {
  return {.guard = guard,
          .session_id = kCycleSession,
          .joint_count = kCycleJoints,
          .rate_Hz = kRate_Hz};
}

ProviderCycle ArmedCycle(GuardConfig guard = {}) {
  ProviderCycle cycle(Config(guard));
  cycle.ArmAtStart();
  return cycle;
}

JointSetpoints Torques(std::uint64_t tick, double first_Nm, double second_Nm) {
  JointSetpoints command;
  command.header = {.session_id = kCycleSession, .tick = tick, .origin = Origin::kSim};
  command.joint_count = kCycleJoints;
  command.mode = {ControlMode::kTorque, ControlMode::kTorque};
  command.motor_torque_Nm = {first_Nm, second_Nm};
  return command;
}

ValveCommand Valves(std::uint64_t tick, int joint_count = kCycleJoints) {
  ValveCommand command;
  command.header = {.session_id = kCycleSession, .tick = tick, .origin = Origin::kSim};
  command.joint_count = joint_count;
  command.valve_open = {true, true};
  command.compressor_on = {false, true};
  command.vent_open = {true, false};
  return command;
}

OperatorResult Order(ProviderCycle* cycle, OperatorAction action, std::uint64_t tick = 0,
                     std::uint64_t session = kCycleSession) {
  return cycle->Take(OperatorCommand{.session_id = session, .action = action}, tick);
}

// Modes of both joints in the command of a tick.
std::array<ControlMode, kCycleJoints> Modes(ProviderCycle* cycle, std::uint64_t tick,
                                            const PlantSensors& sensors = {}) {
  const PlantCommand& command = cycle->Command(tick, sensors);
  return {command.mode[0], command.mode[1]};
}

constexpr std::array kIdle{ControlMode::kIdle, ControlMode::kIdle};
constexpr std::array kTorque{ControlMode::kTorque, ControlMode::kTorque};
constexpr std::array kPosition{ControlMode::kPosition, ControlMode::kPosition};

TEST(ProviderCycle, StartsDisarmedAndIdlesWhateverIsCommanded) {
  ProviderCycle cycle(Config());
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_TRUE(cycle.Take(Torques(0, 0.01, 0.02), 0));
  const PlantCommand& command = cycle.Command(0, {});
  EXPECT_EQ(command.mode[0], ControlMode::kIdle);
  EXPECT_EQ(command.motor_torque_Nm[0], 0.0);
}

TEST(ProviderCycle, AnOperatorArmsTheSessionThatHeMeansOnly) {
  ProviderCycle cycle(Config());
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 0, kCycleSession + 1),
            OperatorResult::kRefusedOtherSession);
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kDone);
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
}

TEST(ProviderCycle, AnArmedRobotGetsTheNewestCommandOfItsTick) {
  ProviderCycle cycle = ArmedCycle();
  EXPECT_EQ(Modes(&cycle, 0), kIdle) << "nothing was commanded yet";
  JointSetpoints sent = Torques(1, 0.01, -0.02);
  sent.mode[1] = ControlMode::kPosition;
  sent.position_rad[1] = 0.3;
  sent.velocity_rad_s[1] = -0.4;
  ASSERT_TRUE(cycle.Take(sent, 1));
  const PlantCommand& command = cycle.Command(1, {});
  EXPECT_EQ(command.mode[0], ControlMode::kTorque);
  EXPECT_EQ(command.motor_torque_Nm[0], 0.01);
  EXPECT_EQ(command.mode[1], ControlMode::kPosition);
  EXPECT_EQ(command.motor_torque_Nm[1], -0.02);
  EXPECT_EQ(command.position_rad[1], 0.3);
  EXPECT_EQ(command.velocity_rad_s[1], -0.4);
}

// Joints are bound by their index: a command for others would move the wrong ones.
TEST(ProviderCycle, ACommandOfAnotherNumberOfJointsIsNotObeyedAndLetsNobodyArm) {
  ProviderCycle cycle(Config());
  const auto of_joints = [](std::uint64_t tick, int joints) {
    JointSetpoints sent = Torques(tick, 0.01, 0.02);
    sent.joint_count = joints;
    return sent;
  };
  for (const int joints : {kCycleJoints - 1, kCycleJoints + 1}) {
    EXPECT_FALSE(cycle.Take(of_joints(0, joints), 0));
    EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kRefusedByCommand);
  }
  EXPECT_TRUE(cycle.Take(of_joints(1, kCycleJoints), 1));
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 1), OperatorResult::kDone);
  JointSetpoints foreign = of_joints(2, kCycleJoints - 1);
  foreign.header.session_id = kCycleSession + 1;
  EXPECT_FALSE(cycle.Take(foreign, 2));
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
  EXPECT_FALSE(cycle.Take(of_joints(2, kCycleJoints - 1), 2));
  EXPECT_EQ(cycle.state(), RobotState::kFault);
  EXPECT_EQ(cycle.fault().cause, FaultCause::kCommandJoints);
  EXPECT_EQ(Modes(&cycle, 2), kIdle);
}

TEST(ProviderCycle, CommandsOfAnotherSessionTheFutureOrThePastAreRefused) {
  ProviderCycle cycle = ArmedCycle();
  ASSERT_TRUE(cycle.Take(Torques(5, 0.01, 0.01), 5));
  JointSetpoints foreign = Torques(6, 0.05, 0.05);
  foreign.header.session_id = kCycleSession + 1;
  EXPECT_FALSE(cycle.Take(foreign, 6));
  EXPECT_EQ(cycle.joint_answers(), 6u) << "a foreign session answers nothing";
  EXPECT_FALSE(cycle.Take(Torques(7, 0.05, 0.05), 6)) << "from the future";
  EXPECT_FALSE(cycle.Take(Torques(5, 0.05, 0.05), 6)) << "a repetition";
  EXPECT_FALSE(cycle.Take(Torques(4, 0.05, 0.05), 6)) << "older than the last";
  EXPECT_EQ(cycle.refused(), 4u);
  EXPECT_EQ(cycle.Command(6, {}).motor_torque_Nm[0], 0.01) << "the last accepted one counts";
}

TEST(ProviderCycle, LiveHardwareTakesLiveCommandsOnly) {
  ProviderCycle cycle = ArmedCycle({.live = true});
  for (const Origin origin : {Origin::kSim, Origin::kReplay}) {
    JointSetpoints joints = Torques(1, 0.01, 0.01);
    joints.header.origin = origin;
    EXPECT_FALSE(cycle.Take(joints, 1));
    ValveCommand valves = Valves(1);
    valves.header.origin = origin;
    EXPECT_FALSE(cycle.Take(valves, 1));
  }
  EXPECT_EQ(Modes(&cycle, 1), kIdle);
  EXPECT_FALSE(cycle.Command(1, {}).valve_open[0]);
  JointSetpoints joints = Torques(1, 0.01, 0.01);
  joints.header.origin = Origin::kLive;
  EXPECT_TRUE(cycle.Take(joints, 1));
  ValveCommand valves = Valves(1);
  valves.header.origin = Origin::kLive;
  EXPECT_TRUE(cycle.Take(valves, 1));
  EXPECT_EQ(Modes(&cycle, 1), kTorque);
  EXPECT_TRUE(cycle.Command(1, {}).valve_open[0]);
}

TEST(ProviderCycle, AControllerThatNamesItsJointsOtherwiseIsNotObeyedAndLetsNobodyArm) {
  ProviderCycle cycle(Config());
  JointSetpoints other = Torques(0, 0.01, 0.02);
  other.other_joint = 1;
  EXPECT_FALSE(cycle.Take(other, 0));
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kRefusedByCommand);
  EXPECT_EQ(cycle.CommandFault().cause, FaultCause::kCommandNames);
  EXPECT_EQ(cycle.CommandFault().joint, 1);
  EXPECT_TRUE(cycle.Take(Torques(1, 0.01, 0.02), 1));
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 1), OperatorResult::kDone);
  other.header.tick = 2;
  EXPECT_FALSE(cycle.Take(other, 2));
  EXPECT_EQ(cycle.state(), RobotState::kFault);
  EXPECT_EQ(Modes(&cycle, 2), kIdle);
}

TEST(ProviderCycle, ASimulationTakesCommandsOfAReplay) {
  ProviderCycle cycle = ArmedCycle();
  JointSetpoints joints = Torques(1, 0.01, 0.01);
  joints.header.origin = Origin::kReplay;
  EXPECT_TRUE(cycle.Take(joints, 1));
}

TEST(ProviderCycle, DisarmAndEstopIdleAtOnce) {
  for (const OperatorAction action : {OperatorAction::kDisarm, OperatorAction::kEstop}) {
    ProviderCycle cycle = ArmedCycle();
    ASSERT_TRUE(cycle.Take(Torques(1, 0.01, 0.01), 1));
    ASSERT_EQ(Modes(&cycle, 1), kTorque);
    EXPECT_EQ(Order(&cycle, action, 1), OperatorResult::kDone);
    EXPECT_EQ(Modes(&cycle, 1), kIdle);
  }
}

TEST(ProviderCycle, AnEstopEndsByResetAndThenArming) {
  ProviderCycle cycle = ArmedCycle();
  Order(&cycle, OperatorAction::kEstop);
  EXPECT_EQ(cycle.state(), RobotState::kEstopped);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kRefusedResetFirst);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset), OperatorResult::kClearFaults);
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kDone);
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
}

TEST(ProviderCycle, AResetWhileArmedOrDampedIsRefused) {
  ProviderCycle cycle = ArmedCycle();
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset), OperatorResult::kRefusedDisarmFirst);
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
  (void)cycle.Command(3, {});
  ASSERT_EQ(cycle.state(), RobotState::kDamped);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset), OperatorResult::kRefusedDisarmFirst);
  EXPECT_EQ(cycle.state(), RobotState::kDamped);
}

TEST(ProviderCycle, AResetWhileDisarmedClearsThePlantsFaults) {
  ProviderCycle cycle(Config());
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset), OperatorResult::kClearFaults);
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
}

TEST(ProviderCycle, StartAndStopAreNotForTheProvider) {
  ProviderCycle cycle = ArmedCycle();
  EXPECT_EQ(Order(&cycle, OperatorAction::kStart), OperatorResult::kNotForProvider);
  EXPECT_EQ(Order(&cycle, OperatorAction::kStop), OperatorResult::kNotForProvider);
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
}

TEST(ProviderCycle, AStaleCommandIsDampedAgainstTheMotorsVelocityAndThenAFault) {
  GuardConfig guard;
  guard.damping_Nm_s_rad = 2e-5;
  ProviderCycle cycle = ArmedCycle(guard);
  ASSERT_TRUE(cycle.Take(Torques(10, 0.01, 0.01), 10));
  ASSERT_EQ(cycle.Command(12, {}).motor_torque_Nm[0], 0.01) << "two periods are bridged by it";
  PlantSensors sensors;
  sensors.motor_velocity_rad_s = {100.0, -50.0};
  const PlantCommand& command = cycle.Command(13, sensors);
  EXPECT_EQ(cycle.state(), RobotState::kDamped);
  EXPECT_EQ(command.mode[0], ControlMode::kTorque);
  EXPECT_DOUBLE_EQ(command.motor_torque_Nm[0], -2e-3);
  EXPECT_DOUBLE_EQ(command.motor_torque_Nm[1], 1e-3);
  EXPECT_EQ(Modes(&cycle, 24, sensors), kTorque) << "58.3 ms";
  EXPECT_EQ(Modes(&cycle, 25, sensors), kIdle) << "62.5 ms";
  EXPECT_EQ(cycle.state(), RobotState::kFault);
  EXPECT_TRUE(cycle.Take(Torques(26, 0.01, 0.01), 26));
  EXPECT_EQ(Modes(&cycle, 26), kIdle) << "a fault is latched";
}

TEST(ProviderCycle, HoldingKeepsThePositionOfItsFirstCycle) {
  ProviderCycle cycle = ArmedCycle({.bridging = Bridging::kHold});
  JointSetpoints moving = Torques(1, 0.01, 0.01);
  moving.velocity_rad_s = {0.5, 0.5};
  ASSERT_TRUE(cycle.Take(moving, 1));
  ASSERT_EQ(Modes(&cycle, 1), kTorque);
  PlantSensors sensors;
  sensors.position_rad = {0.7, -0.2};
  EXPECT_EQ(Modes(&cycle, 4, sensors), kPosition);
  EXPECT_EQ(cycle.Command(4, sensors).position_rad[1], -0.2);
  sensors.position_rad = {0.9, 0.1};
  const PlantCommand& later = cycle.Command(5, sensors);
  EXPECT_EQ(later.position_rad[0], 0.7);
  EXPECT_EQ(later.position_rad[1], -0.2);
  EXPECT_EQ(later.velocity_rad_s[0], 0.0);
  EXPECT_EQ(later.motor_torque_Nm[0], 0.0);
  ASSERT_TRUE(cycle.Take(Torques(6, 0.01, 0.01), 6));
  ASSERT_EQ(Modes(&cycle, 6, sensors), kTorque) << "a fresh command ends holding";
  EXPECT_EQ(cycle.Command(9, sensors).position_rad[0], 0.9) << "holds anew where it is now";
}

TEST(ProviderCycle, ACommandThatIsNotFiniteIdlesAllJointsAtOnceAndIsAFault) {
  for (const auto field : {&JointSetpoints::motor_torque_Nm, &JointSetpoints::position_rad,
                           &JointSetpoints::velocity_rad_s}) {
    for (const double value : {kNaN, std::numeric_limits<double>::infinity()}) {
      for (const std::size_t bad : {0u, 1u}) {
        ProviderCycle cycle = ArmedCycle();
        JointSetpoints sent = Torques(1, 0.01, 0.02);
        (sent.*field)[bad] = value;
        ASSERT_TRUE(cycle.Take(sent, 1));
        const PlantCommand& command = cycle.Command(1, {});
        for (const std::size_t j : {0u, 1u}) {
          EXPECT_EQ(command.mode[j], ControlMode::kIdle) << j << ", bad " << bad;
          EXPECT_EQ(command.motor_torque_Nm[j], 0.0) << j << ", bad " << bad;
        }
        EXPECT_EQ(cycle.state(), RobotState::kFault);
        EXPECT_EQ(cycle.fault().cause, FaultCause::kCommandNotFinite);
        EXPECT_EQ(cycle.fault().joint, static_cast<int>(bad));
        EXPECT_EQ(Modes(&cycle, 2), kIdle);
      }
    }
  }
}

// A cycle of hardware: it ages by the clock. The commands of ticks up to 10 came in time.
ProviderCycle ClockedCycle() {
  CycleConfig config = Config();
  config.ages_by_clock = true;
  ProviderCycle cycle(config);
  cycle.ArmAtStart();
  for (std::uint64_t tick = 0; tick <= 10; ++tick) {
    const auto now_ns = static_cast<std::int64_t>(tick) * 4'166'667;
    EXPECT_FALSE(cycle.Begin(tick, now_ns));
    EXPECT_TRUE(cycle.Take(Torques(tick, 0.01, 0.02), tick));
    (void)cycle.Command(tick, {}, now_ns + 2'000'000);
  }
  return cycle;
}
constexpr std::int64_t kTick10_ns = 10 * 4'166'667LL;

TEST(ProviderCycle, AStallBetweenCyclesIsAFaultAlthoughNoTickIsMissing) {
  for (const int stall_ms : {61, 80, 100, 5000}) {
    ProviderCycle cycle = ClockedCycle();
    const std::int64_t now_ns = kTick10_ns + stall_ms * 1'000'000LL;
    EXPECT_TRUE(cycle.Begin(11, now_ns)) << stall_ms;
    EXPECT_EQ(cycle.state(), RobotState::kFault);
    EXPECT_EQ(cycle.fault().cause, FaultCause::kCycleLate);
    EXPECT_NEAR(cycle.fault().value, stall_ms, 1e-6);
    EXPECT_EQ(cycle.Command(11, {}, now_ns).mode[0], ControlMode::kIdle) << stall_ms;
  }
  ProviderCycle cycle = ClockedCycle();
  EXPECT_FALSE(cycle.Begin(11, kTick10_ns + 59'000'000));
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
}

TEST(ProviderCycle, ACommandFromBeforeAStallIsNotExecutedAfterIt) {
  for (const int stall_ms : {17, 40, 64, 90}) {
    ProviderCycle cycle = ClockedCycle();
    ASSERT_FALSE(cycle.Begin(11, kTick10_ns + 4'166'667));
    // The controller answers at once; this provider reads the answer only after its stall.
    ASSERT_TRUE(cycle.Take(Torques(11, 0.5, 0.5), 11));
    const std::int64_t now_ns = kTick10_ns + 4'166'667 + stall_ms * 1'000'000LL;
    const PlantCommand& command = cycle.Command(11, {}, now_ns);
    EXPECT_NE(command.motor_torque_Nm[0], 0.5) << stall_ms;
    EXPECT_EQ(cycle.state(), stall_ms > 64 ? RobotState::kFault : RobotState::kDamped) << stall_ms;
  }
}

TEST(ProviderCycle, ADisarmedRobotHasNoFaultAfterAStall) {
  CycleConfig config = Config();
  config.ages_by_clock = true;
  ProviderCycle cycle(config);
  EXPECT_FALSE(cycle.Begin(0, 0));
  EXPECT_FALSE(cycle.Begin(1, 1'000'000'000));
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
}

TEST(ProviderCycle, AResetIsForItsOwnSessionOnly) {
  ProviderCycle cycle = ArmedCycle();
  ASSERT_EQ(Order(&cycle, OperatorAction::kEstop, 0, kCycleSession + 1), OperatorResult::kDone)
      << "an estop counts whoever says it";
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset, 1, kCycleSession + 1),
            OperatorResult::kRefusedOtherSession);
  EXPECT_EQ(cycle.state(), RobotState::kEstopped);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset, 1), OperatorResult::kClearFaults);
}

TEST(ProviderCycle, AResetOfALatchedEstopWaitsForTheLatchToGo) {
  CycleConfig config = Config();
  config.estop_is_latched = true;
  ProviderCycle cycle(config);
  cycle.ArmAtStart();
  EXPECT_FALSE(cycle.FinishReset()) << "there is nothing to reset";
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
  ASSERT_EQ(Order(&cycle, OperatorAction::kEstop, 0), OperatorResult::kDone);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset, 1), OperatorResult::kUnlatchFirst);
  EXPECT_EQ(cycle.state(), RobotState::kEstopped);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 1), OperatorResult::kRefusedResetFirst);
  EXPECT_EQ(Modes(&cycle, 1), kIdle);
  EXPECT_TRUE(cycle.FinishReset());
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 2), OperatorResult::kDone);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset, 2, kCycleSession + 1),
            OperatorResult::kRefusedOtherSession);
}

TEST(ProviderCycle, APlantThatMayNotBeArmedIsNotArmed) {
  CycleConfig config = Config();
  config.plant_may_be_armed = false;
  ProviderCycle cycle(config);
  cycle.ArmAtStart();
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 0, kCycleSession + 1),
            OperatorResult::kRefusedOtherSession);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kRefusedByPlant);
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_EQ(Order(&cycle, OperatorAction::kEstop), OperatorResult::kDone);
}

TEST(ProviderCycle, WhereArmingNeedsAnswersItWaitsForAControllerThatIsThere) {
  CycleConfig config = Config();
  config.arm_needs_answers = true;
  ProviderCycle cycle(config);
  EXPECT_FALSE(cycle.ArmAtStart());
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm), OperatorResult::kRefusedUnanswered);
  JointSetpoints other = Torques(100, 0.0, 0.0);
  other.joint_count = 1;
  EXPECT_FALSE(cycle.Take(other, 100));
  EXPECT_FALSE(cycle.ArmAtStart(100)) << "it is of another robot";
  ASSERT_TRUE(cycle.Take(Torques(101, 0.0, 0.0), 101));
  // 60 ms are 14.4 periods.
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 117), OperatorResult::kRefusedUnanswered)
      << "it has gone";
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  EXPECT_TRUE(cycle.ArmAtStart(116));
  EXPECT_EQ(Modes(&cycle, 116), kIdle) << "a command from before arming";
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
  ASSERT_EQ(Order(&cycle, OperatorAction::kEstop, 200), OperatorResult::kDone);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 300), OperatorResult::kRefusedResetFirst);
}

TEST(ProviderCycle, AFaultIsResetAtOnceWhereOnlyEstopsAreLatched) {
  CycleConfig config = Config();
  config.estop_is_latched = true;
  ProviderCycle cycle(config);
  PlantSensors sensors;
  sensors.fault = true;
  ASSERT_EQ(cycle.Observe(sensors), FaultChange::kRobot);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset, 1), OperatorResult::kClearFaults);
}

TEST(ProviderCycle, ARecordingNeitherArmsNorResetsButMayStop) {
  for (const bool live : {true, false}) {
    ProviderCycle cycle(Config({.live = live}));
    const auto order = [&cycle](OperatorAction action, Origin origin) {
      return cycle.Take({.session_id = kCycleSession, .origin = origin, .action = action}, 0);
    };
    EXPECT_EQ(order(OperatorAction::kArm, Origin::kReplay), OperatorResult::kRefusedOrigin);
    EXPECT_EQ(order(OperatorAction::kArm, Origin::kSim) == OperatorResult::kDone, !live);
    EXPECT_EQ(order(OperatorAction::kArm, Origin::kLive), OperatorResult::kDone);
    EXPECT_EQ(order(OperatorAction::kEstop, Origin::kReplay), OperatorResult::kDone);
    EXPECT_EQ(order(OperatorAction::kReset, Origin::kReplay), OperatorResult::kRefusedOrigin);
    EXPECT_EQ(cycle.state(), RobotState::kEstopped);
  }
}

TEST(ProviderCycle, RelaysOfAStoppedRobotAreOffOrLetTheAirOutAsDeclared) {
  for (const ValvesInFault declared : {ValvesInFault::kHold, ValvesInFault::kVent}) {
    for (const OperatorAction action : {OperatorAction::kEstop, OperatorAction::kDisarm}) {
      ProviderCycle cycle = ArmedCycle({.valves_in_fault = declared});
      ASSERT_TRUE(cycle.Take(Valves(1), 1));
      ASSERT_EQ(Order(&cycle, action, 1), OperatorResult::kDone);
      const PlantCommand& command = cycle.Command(1, {});
      const bool stopped = action == OperatorAction::kEstop;
      const bool vents = declared == ValvesInFault::kVent;
      for (const std::size_t j : {0u, 1u}) {
        EXPECT_EQ(command.valve_open[j], stopped ? vents : Valves(1).valve_open[j]) << j;
        EXPECT_EQ(command.vent_open[j], stopped ? vents : Valves(1).vent_open[j]) << j;
        EXPECT_EQ(command.compressor_on[j], !stopped && Valves(1).compressor_on[j]) << j;
      }
    }
  }
  ProviderCycle cycle = ArmedCycle();
  ASSERT_TRUE(cycle.Take(Valves(1), 1));
  JointSetpoints sent = Torques(1, kNaN, 0.0);
  ASSERT_TRUE(cycle.Take(sent, 1));
  EXPECT_FALSE(cycle.Command(1, {}).valve_open[0]) << "in the very cycle of the fault";
}

TEST(ProviderCycle, RelaysFollowTheirCommandWhoeverMovesAndAreOffWithoutOne) {
  ProviderCycle cycle(Config());
  EXPECT_FALSE(cycle.Command(0, {}).valve_open[0]);
  ASSERT_TRUE(cycle.Take(Valves(10), 10));
  const PlantCommand& command = cycle.Command(10, {});
  EXPECT_EQ(cycle.state(), RobotState::kDisarmed);
  for (int j = 0; j < kCycleJoints; ++j) {
    const auto at = static_cast<std::size_t>(j);
    EXPECT_EQ(command.valve_open[at], Valves(10).valve_open[at]);
    EXPECT_EQ(command.compressor_on[at], Valves(10).compressor_on[at]);
    EXPECT_EQ(command.vent_open[at], Valves(10).vent_open[at]);
  }
  EXPECT_TRUE(cycle.Command(24, {}).valve_open[0]) << "58.3 ms old";
  EXPECT_FALSE(cycle.Command(25, {}).valve_open[0]) << "62.5 ms old";
  EXPECT_FALSE(cycle.Command(25, {}).compressor_on[1]);
  EXPECT_FALSE(cycle.Command(25, {}).vent_open[0]);
  ASSERT_TRUE(cycle.Take(Valves(26, 1), 26));
  EXPECT_TRUE(cycle.Command(26, {}).valve_open[0]);
  EXPECT_FALSE(cycle.Command(26, {}).valve_open[1]) << "a joint that the command does not name";
}

TEST(ProviderCycle, ValveCommandsOfAnotherSessionOrTheFutureAreRefused) {
  ProviderCycle cycle(Config());
  ValveCommand foreign = Valves(1);
  foreign.header.session_id = kCycleSession + 1;
  EXPECT_FALSE(cycle.Take(foreign, 1));
  EXPECT_EQ(cycle.valve_answers(), 0u);
  EXPECT_FALSE(cycle.Take(Valves(2), 1));
  EXPECT_FALSE(cycle.Command(1, {}).valve_open[0]);
}

TEST(ProviderCycle, AValveCommandThatComesLateIsDropped) {
  ProviderCycle cycle(Config());
  ASSERT_TRUE(cycle.Take(Valves(10), 10));
  ValveCommand late = Valves(9);
  late.valve_open = {};
  EXPECT_FALSE(cycle.Take(late, 10));
  late.header.tick = 10;
  EXPECT_FALSE(cycle.Take(late, 10)) << "the tick is answered already";
  EXPECT_EQ(cycle.valve_answers(), 11u);
  EXPECT_TRUE(cycle.Command(10, {}).valve_open[0]);
}

TEST(ProviderCycle, AFaultOfThePlantIsLatchedUntilResetAndArming) {
  ProviderCycle cycle = ArmedCycle();
  ASSERT_TRUE(cycle.Take(Torques(1, 0.01, 0.01), 1));
  EXPECT_EQ(cycle.Observe({}), FaultChange::kNone);
  PlantSensors sensors;
  sensors.fault = true;
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kRobot);
  EXPECT_EQ(cycle.state(), RobotState::kFault);
  EXPECT_EQ(cycle.Observe({}), FaultChange::kNone);
  EXPECT_EQ(Modes(&cycle, 2), kIdle) << "the plant recovered, the latch did not";
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 2), OperatorResult::kRefusedResetFirst);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset, 2), OperatorResult::kClearFaults);
  EXPECT_EQ(Order(&cycle, OperatorAction::kArm, 2), OperatorResult::kDone);
  ASSERT_TRUE(cycle.Take(Torques(3, 0.01, 0.01), 3));
  EXPECT_EQ(Modes(&cycle, 3), kTorque);
}

// State and modes after joint 0 got a fault of its own while both were commanded torque.
struct AfterJointFault {
  RobotState state;
  std::array<ControlMode, kCycleJoints> modes;
};
AfterJointFault After(OtherJointsPolicy policy) {
  ProviderCycle cycle = ArmedCycle({.on_joint_fault = policy});
  EXPECT_TRUE(cycle.Take(Torques(1, 0.01, 0.01), 1));
  EXPECT_EQ(Modes(&cycle, 1), kTorque);
  PlantSensors sensors;
  sensors.joint_fault[0] = {FaultCause::kOverspeed};
  sensors.position_rad[1] = 0.4;
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kJoint);
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kNone) << "reported once";
  EXPECT_TRUE(cycle.Take(Torques(2, 0.01, 0.01), 2));
  const auto modes = Modes(&cycle, 2, sensors);
  return {cycle.state(), modes};
}

TEST(ProviderCycle, AJointWithAFaultIdlesAndTheOthersFollowTheirPolicy) {
  const AfterJointFault idle = After(OtherJointsPolicy::kIdle);
  EXPECT_EQ(idle.state, RobotState::kFault);
  EXPECT_EQ(idle.modes, kIdle);
  const AfterJointFault damp = After(OtherJointsPolicy::kDamp);
  EXPECT_EQ(damp.state, RobotState::kFault);
  EXPECT_EQ(damp.modes, (std::array{ControlMode::kIdle, ControlMode::kTorque}));
  const AfterJointFault hold = After(OtherJointsPolicy::kHold);
  EXPECT_EQ(hold.state, RobotState::kFault);
  EXPECT_EQ(hold.modes, (std::array{ControlMode::kIdle, ControlMode::kPosition}));
  const AfterJointFault on = After(OtherJointsPolicy::kContinue);
  EXPECT_EQ(on.state, RobotState::kArmed);
  EXPECT_EQ(on.modes, (std::array{ControlMode::kIdle, ControlMode::kTorque}));
}

TEST(ProviderCycle, FaultsOfAllJointsAreTheRobotsWhateverThePolicy) {
  ProviderCycle cycle = ArmedCycle({.on_joint_fault = OtherJointsPolicy::kContinue});
  PlantSensors sensors;
  sensors.joint_fault[0] = {FaultCause::kOverspeed};
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kJoint);
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
  sensors.joint_fault[1] = {FaultCause::kOverspeed};
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kRobot);
  EXPECT_EQ(cycle.state(), RobotState::kFault);
}

TEST(ProviderCycle, AJointsFaultThatReturnsAfterAResetIsReportedAgain) {
  ProviderCycle cycle(Config());
  PlantSensors sensors;
  sensors.joint_fault[1] = {FaultCause::kOverspeed};
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kJoint);
  EXPECT_EQ(Order(&cycle, OperatorAction::kReset), OperatorResult::kClearFaults);
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kJoint);
}

TEST(ProviderCycle, JointsBeyondTheRobotsDoNotCount) {
  ProviderCycle cycle = ArmedCycle();
  PlantSensors sensors;
  sensors.joint_fault[kCycleJoints] = {FaultCause::kOverspeed};
  EXPECT_EQ(cycle.Observe(sensors), FaultChange::kNone);
  JointSetpoints sent = Torques(1, 0.01, 0.01);
  sent.motor_torque_Nm[kCycleJoints] = kNaN;
  ASSERT_TRUE(cycle.Take(sent, 1));
  EXPECT_EQ(Modes(&cycle, 1), kTorque);
}

TEST(ProviderCycle, ACommandIsAwaitedWhileTheRobotMayMoveAndHasNotAnswered) {
  ProviderCycle cycle(Config());
  EXPECT_FALSE(cycle.AwaitsCommand(0)) << "disarmed";
  cycle.ArmAtStart();
  EXPECT_TRUE(cycle.AwaitsCommand(1));
  EXPECT_TRUE(cycle.Take(Torques(1, 0.01, 0.01), 1));
  EXPECT_FALSE(cycle.AwaitsCommand(1)) << "answered";
  EXPECT_TRUE(cycle.AwaitsCommand(2));
  EXPECT_FALSE(cycle.Overdue(4));
  EXPECT_TRUE(cycle.Overdue(5)) << "more than three periods";
  Order(&cycle, OperatorAction::kEstop, 2);
  EXPECT_FALSE(cycle.AwaitsCommand(2));
}

TEST(ProviderCycle, HeadersSaySessionTickOriginAndTime) {
  CycleConfig config = Config();
  const types::MessageHeader real = ProviderCycle(config).Header(3, 123456789);
  EXPECT_EQ(real.session_id, kCycleSession);
  EXPECT_EQ(real.tick, 3u);
  EXPECT_EQ(real.stamp_ns, 123456789);
  EXPECT_EQ(real.origin, Origin::kSim);
  config.guard.live = true;
  EXPECT_EQ(ProviderCycle(config).Header(3, 0).origin, Origin::kLive);
  config.simulated_time = true;
  // round(3e9 / 240)
  EXPECT_EQ(ProviderCycle(config).Header(3, 123456789).stamp_ns, 12500000);
}

TEST(ProviderCycle, TheLastTickIsThatOfTheDuration) {
  CycleConfig config = Config();
  EXPECT_FALSE(ProviderCycle(config).last(0));
  config.duration_s = 0.5;
  const ProviderCycle cycle(config);
  EXPECT_FALSE(cycle.last(118));
  EXPECT_TRUE(cycle.last(119)) << "ticks 0 to 119 are half a second";
  EXPECT_FALSE(cycle.last(120));
}

TEST(ProviderCycle, RefusesConfigurationsWithoutMeaning) {
  for (const int joints : {0, -1, types::kMaxJoints + 1}) {
    CycleConfig config = Config();
    config.joint_count = joints;
    EXPECT_THROW(ProviderCycle{config}, std::invalid_argument) << joints;
  }
  for (const double rate_Hz : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) {
    CycleConfig config = Config();
    config.rate_Hz = rate_Hz;
    EXPECT_THROW(ProviderCycle{config}, std::invalid_argument) << rate_Hz;
  }
  EXPECT_THROW(ProviderCycle{Config({.missed_periods = 0})}, std::invalid_argument);
}

TEST(ProviderCycle, AHundredThousandCyclesAllocateNothing) {
  ProviderCycle cycle = ArmedCycle();
  PlantSensors sensors;
  const long before = test::Allocations();
  double sum_Nm = 0.0;
  for (std::uint64_t tick = 1; tick <= 100'000; ++tick) {
    cycle.Take(Torques(tick, 1e-3, 2e-3), tick);
    cycle.Take(Valves(tick), tick);
    sum_Nm += cycle.Command(tick, sensors).motor_torque_Nm[1];
    cycle.Observe(sensors);
  }
  EXPECT_EQ(test::Allocations(), before);
  EXPECT_NEAR(sum_Nm, 200.0, 1e-6);
  EXPECT_EQ(cycle.state(), RobotState::kArmed);
}

// Reference values: the first outputs of splitmix64 for the seeds 0 and 1 (Vigna's splitmix64.c),
// with the lowest bit set.
TEST(SessionFromSeed, IsSplitmixAndNeverZero) {
  EXPECT_EQ(SessionFromSeed(0), 0xE220A8397B1DCDAFull);
  EXPECT_EQ(SessionFromSeed(1), 0x910A2DEC89025CC1ull);
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) seen.insert(SessionFromSeed(seed));
  EXPECT_EQ(seen.size(), 1000u);
  EXPECT_EQ(seen.count(0), 0u);
}

}  // namespace
}  // namespace sinew::provider
