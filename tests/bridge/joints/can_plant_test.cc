// The bridge against virtual controllers on a bus in memory: simulated time, every frame seen.
#include "bridge/joints/can_plant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>

#include "bridge/can/bit_timing.h"
#include "components/types/angle.h"
#include "components/types/control_mode.h"
#include "tests/bridge/joints/plant_bench.h"
#include "tests/support/allocations.h"

namespace sinew::bridge {
namespace {

using std::chrono::milliseconds;
using types::ControlMode;

TEST(CanPlant, SensorsAreThePlantsThroughFrames) {
  Bench bench;
  bench.rotors.angle_rad[0] = 30.0;
  bench.rotors.pressure_bar[0] = 4.2;
  bench.rotors.temperature_degC[0] = 31.4;
  bench.Start();
  EXPECT_NEAR(bench.sensors.motor_position_rad[0], 30.0, 1e-5);
  EXPECT_NEAR(bench.sensors.position_rad[0], 0.3, 1e-6);
  EXPECT_NEAR(bench.sensors.chamber_pressure_bar[0], 4.2, 1e-9);
  EXPECT_NEAR(bench.sensors.motor_temperature_degC[0], 31.4, 1e-9);
  EXPECT_TRUE(bench.sensors.valid[0]);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_LT(bench.sensors.age_us[0], 10'000);
}

// The law that matters: whatever direction, zero and constant the controller has, the motor feels
// the torque.
class Conventions : public ::testing::TestWithParam<int> {};

TEST_P(Conventions, MotorFeelsTheCommandedTorque) {
  Bench bench({.direction = GetParam(), .zero_rev = 3.7});
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.0011;
  bench.Steps(3);
  // float32 on the wire: 24 bits
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.0011, 1e-9);
  bench.Steps(60);
  EXPECT_GT(bench.rotors.velocity_rad_s[0], 5.0) << "positive drives up";
  EXPECT_NEAR(bench.sensors.motor_velocity_rad_s[0], bench.rotors.velocity_rad_s[0],
              0.02 * bench.rotors.velocity_rad_s[0]);
  EXPECT_NEAR(bench.sensors.motor_current_A[0], 0.0011 / test::Rotors::kTorqueConstant_Nm_A, 1e-6);
  EXPECT_NEAR(bench.sensors.torque_Nm[0], 100 * 0.0011, 1e-6);
  EXPECT_GT(bench.sensors.position_rad[0], 0.0);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

INSTANTIATE_TEST_SUITE_P(Directions, Conventions, ::testing::Values(1, -1));

TEST(CanPlant, WithoutAnOutputNodeThePositionIsTheMotors) {
  Bench bench({.output_nodes = false});
  bench.rotors.angle_rad[0] = 30.0;
  bench.Start();
  EXPECT_NEAR(bench.sensors.position_rad[0], 0.3, 1e-6);
  EXPECT_EQ(bench.plant->measured_flags() & 1u, 0u) << "not measured";
  Bench with;
  with.Start();
  EXPECT_EQ(with.plant->measured_flags() & 1u, 1u);
}

TEST(CanPlant, NoTorqueLeavesBeforeTheAxisSaysClosedLoop) {
  Bench bench;
  bench.Start();
  bool closed_loop_heard = false;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (const auto h = can::Decode<can::Heartbeat>(d.frame);
        h && can::AddressOf(d.frame)->node == 1) {
      closed_loop_heard = h->axis_state == can::AxisState::kClosedLoopControl;
    }
    if (const auto t = can::Decode<can::SetInputTorque>(d.frame); t && t->torque_Nm != 0.0) {
      EXPECT_TRUE(closed_loop_heard);
    }
  });
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Arm();
  bench.Steps(10);
  EXPECT_TRUE(closed_loop_heard);
  EXPECT_GT(bench.rotors.torque_Nm[0], 0.0);
}

TEST(CanPlant, IdleEndsTheTorqueWithinTwoCyclesAndTheAxisGoesIdle) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Steps(5);
  ASSERT_GT(bench.rotors.torque_Nm[0], 0.0);
  bench.command.mode[0] = ControlMode::kIdle;
  bench.Steps(2);
  EXPECT_EQ(bench.rotors.torque_Nm[0], 0.0);
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kIdle);
}

TEST(CanPlant, ShutDownLeavesTheAxesIdleAndTheRelaysOff) {
  Bench bench({.joints = 2});
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm = {0.001, 0.001};
  bench.command.valve_open = {true, true};
  bench.Steps(5);
  ASSERT_TRUE(bench.axes->valve_open(1));
  bench.plant->ShutDown();
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 5 * kMs_ns);
  for (int j = 0; j < 2; ++j) {
    EXPECT_EQ(bench.axes->axis_state(j), can::AxisState::kIdle);
    EXPECT_EQ(bench.rotors.torque_Nm[static_cast<std::size_t>(j)], 0.0);
    EXPECT_FALSE(bench.axes->valve_open(j));
  }
}

// A reset that comes between a fault and the cycle that would have idled the axis must not let the
// joint go on.
TEST(CanPlant, AfterAResetAJointGoesOnOnlyThroughArming) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Steps(5);
  bench.command.motor_torque_Nm[0] = std::nan("");
  bench.Step();
  ASSERT_EQ(bench.plant->fault(0), FaultKind::kNotFinite);
  bench.plant->ClearFault();
  bench.command.motor_torque_Nm[0] = 0.001;
  bool arming = false;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    const auto state = can::Decode<can::SetAxisState>(d.frame);
    if (state && state->state == can::AxisState::kClosedLoopControl) arming = true;
    const auto torque = can::Decode<can::SetInputTorque>(d.frame);
    if (torque && torque->torque_Nm != 0.0) {
      EXPECT_TRUE(arming);
    }
  });
  bench.Steps(60);
  EXPECT_TRUE(arming);
}

TEST(CanPlant, NoSetpointLeavesForAnAxisThatHasJustToldAnError) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Steps(5);
  bench.axes->SetAxisError(0, can::axis_error::kOverTemp);
  bool told = false;
  int moving = 0;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (const auto h = can::Decode<can::Heartbeat>(d.frame); h && h->axis_error != 0) told = true;
    const auto torque = can::Decode<can::SetInputTorque>(d.frame);
    if (told && torque && torque->torque_Nm != 0.0) ++moving;
  });
  bench.Steps(60);
  EXPECT_TRUE(told);
  EXPECT_EQ(moving, 0);
}

TEST(CanPlant, WatchdogsAreFedWhileTheBridgeLivesAndStopTheMotorWhenItDies) {
  Bench bench({.watchdog_s = 0.05});
  bench.Start();
  bench.Steps(100);  // disarmed: fed all the same
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.0005;
  bench.Steps(200);
  EXPECT_EQ(bench.axes->axis_error(0), 0U);
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 60 * kMs_ns);  // killed
  EXPECT_EQ(bench.rotors.torque_Nm[0], 0.0);
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kIdle);
}

TEST(CanPlant, TorqueAndCurrentAreLimited) {
  Bench bench;
  bench.config.joints[0].limits.motor_torque_Nm = 0.02;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 5.0;
  bench.Steps(2);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.02, 1e-8);

  Bench other;
  other.config.joints[0].limits.current_A = 0.5;
  other.Start();
  other.Arm();
  other.command.motor_torque_Nm[0] = -5.0;
  other.Steps(2);
  EXPECT_NEAR(other.rotors.torque_Nm[0], -0.5 * test::Rotors::kTorqueConstant_Nm_A, 1e-8);
}

TEST(CanPlant, VelocityStaysBelowItsLimitUnderFullTorque) {
  Bench bench;
  bench.config.joints[0].limits.velocity_rad_s = 1.0;
  bench.config.joints[0].limits.upper_rad = 100.0;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.01;
  double fastest_rad_s = 0.0;
  for (int i = 0; i < 600; ++i) {
    bench.Step();
    fastest_rad_s = std::max(fastest_rad_s, bench.rotors.velocity_rad_s[0] / 100.0);
  }
  // The taper closes over the last tenth; one cycle (4.2 ms) of full torque adds 0.04 rad/s.
  EXPECT_LT(fastest_rad_s, 1.05);
  EXPECT_GT(fastest_rad_s, 0.85);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, NoTorqueOutwardsBeyondAPositionLimitButInwardsYes) {
  Bench bench;
  bench.config.joints[0].limits.upper_rad = 0.1;
  bench.rotors.angle_rad[0] = 15.0;  // 0.15 rad
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.005;
  bench.Steps(3);
  EXPECT_EQ(bench.rotors.torque_Nm[0], 0.0);
  bench.command.motor_torque_Nm[0] = -0.005;
  bench.Steps(3);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], -0.005, 1e-8);
}

TEST(CanPlant, FarOutsideIsAFault) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.rotors.angle_rad[0] = 100.0 * 1.75;
  // A jump of the plant is one of the encoder, too; the range must be found where it moved there
  // slowly.
  for (double angle = 0.0; angle < 175.0; angle += 1.5) {
    bench.rotors.angle_rad[0] = angle;
    bench.Step();
  }
  bench.Steps(3);
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kOutOfRange) << bench.sensors.message;
}

TEST(CanPlant, PositionModeLeavesTheMeasuredPositionWithoutAJumpAndNoFasterThanTheLimit) {
  Bench bench;
  bench.config.joints[0].limits.velocity_rad_s = 0.5;
  bench.rotors.angle_rad[0] = 50.0;  // 0.5 rad
  bench.Start();
  double last_rev = 50.0 / types::kTwoPi;
  bool first = true;
  const double most_rev = 0.5 * kPeriod_s * 100.0 / types::kTwoPi;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (const auto p = can::Decode<can::SetInputPos>(d.frame)) {
      EXPECT_LE(std::abs(p->position_rev - last_rev), most_rev * 1.001 + 1e-5)
          << (first ? "first" : "later");
      last_rev = p->position_rev;
      first = false;
    }
  });
  bench.command.position_rad[0] = -9.0;  // beyond the limit as well
  bench.Arm(ControlMode::kPosition);
  bench.Steps(240 * 6);
  EXPECT_FALSE(first);
  EXPECT_NEAR(bench.rotors.angle_rad[0] / 100.0, -1.5, 0.01) << "held at lower_rad";
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, VelocityModeIsLimited) {
  Bench bench;
  bench.config.joints[0].limits.velocity_rad_s = 0.5;
  bench.Start();
  bench.command.velocity_rad_s[0] = 3.0;
  bench.Arm(ControlMode::kVelocity);
  bench.Steps(60);
  EXPECT_NEAR(bench.rotors.velocity_rad_s[0] / 100.0, 0.5, 0.05);
}

TEST(CanPlant, ModeChangesWithoutPassingThroughATorqueStep) {
  Bench bench;
  bench.rotors.angle_rad[0] = 20.0;
  bench.Start();
  bench.Arm(ControlMode::kTorque);
  bench.command.mode[0] = ControlMode::kPosition;
  bench.command.position_rad[0] = 0.2;
  bench.Steps(120);
  EXPECT_NEAR(bench.rotors.angle_rad[0], 20.0, 0.5);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, AxisErrorIsAFaultWithItsNameAndItsCauseAndClearsByReset) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.axes->SetAxisError(0, can::axis_error::kOverTemp);
  bench.Steps(40);
  EXPECT_TRUE(bench.faulty());
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kAxisError);
  EXPECT_NE(bench.sensors.message.find("joint0"), std::string::npos) << bench.sensors.message;
  EXPECT_NE(bench.sensors.message.find("0x40000"), std::string::npos) << bench.sensors.message;
  EXPECT_NE(bench.sensors.message.find("over-temperature"), std::string::npos)
      << bench.sensors.message;
  bench.Steps(100);
  EXPECT_TRUE(bench.faulty()) << "latched";
  bench.plant->ClearFault();
  bench.command.mode[0] = ControlMode::kIdle;
  bench.Steps(60);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_TRUE(bench.sensors.message.empty());
  bench.Arm();
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kClosedLoopControl);
}

TEST(CanPlant, ErrorThatStaysIsAFaultAgainAfterTheReset) {
  Bench bench;
  bench.Start();
  bench.Steps(5);  // the start's own Clear_Errors has been taken
  bench.axes->SetAxisError(0, can::axis_error::kEncoderFailed);
  bench.Steps(40);
  ASSERT_TRUE(bench.faulty());
  bench.plant->ClearFault();
  bench.Steps(2);
  bench.axes->SetAxisError(0, can::axis_error::kEncoderFailed);
  bench.Steps(40);
  EXPECT_TRUE(bench.faulty());
}

TEST(CanPlant, SilentAxisIsNotValidAfterTwentyMillisecondsAndAFaultAfterSixty) {
  Bench bench;
  bench.Start();
  bench.Steps(10);
  bench.axes->Silence(0, true);
  bench.Steps(4);
  EXPECT_TRUE(bench.sensors.valid[0]);
  bench.Steps(3);
  EXPECT_FALSE(bench.sensors.valid[0]);
  EXPECT_FALSE(bench.faulty());
  bench.Steps(12);
  EXPECT_TRUE(bench.faulty());
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kEstimatesLost) << bench.sensors.message;
  EXPECT_GT(bench.sensors.age_us[0], 60'000);
}

TEST(CanPlant, BusThatIsOffIsNamedInTheFault) {
  Bench bench({.output_nodes = false});
  bench.Start();
  bench.Steps(5);
  // An impostor with the bridge's identifiers and other content, until both are bus-off.
  const auto impostor = bench.buses[0]->Join("impostor");
  for (int i = 0; i < 600 && bench.plant->fault(0) == FaultKind::kNone; ++i) {
    (void)impostor->Send(can::Trim(can::Encode(1, can::SetInputTorque{0.5})));
    bench.Step();
  }
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kEstimatesLost);
  EXPECT_NE(bench.sensors.message.find("bus 'bridge' is bus-off"), std::string::npos)
      << bench.sensors.message;
  EXPECT_FALSE(bench.plant->bus_report()->up[0]);
  EXPECT_GT(bench.plant->bus_report()->error_frames[0], 0U);
  EXPECT_EQ(bench.rotors.angle_rad[0], 0.0);
}

TEST(CanPlant, LostHeartbeatIsAFaultEvenWhereEstimatesStillCome) {
  Bench bench;
  bench.axes_config.axes[0].rates.heartbeat_ms = 2000;  // one at the start, the next too late
  bench.Start();
  bench.Steps(240 * 1);
  EXPECT_TRUE(bench.faulty());
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kHeartbeatLost) << bench.sensors.message;
}

TEST(CanPlant, JumpOfTheMotorEncoderIsAFaultOfThatJoint) {
  Bench bench({.joints = 2});
  bench.Start();
  bench.Steps(10);
  bench.rotors.angle_rad[1] += 0.5 * types::kTwoPi;
  bench.Steps(3);
  EXPECT_EQ(bench.plant->fault(1), FaultKind::kEncoderJump) << bench.sensors.message;
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kNone);
  EXPECT_TRUE(bench.faulty());
}

// The controller woke up some turns beside where it was calibrated.
Bench Displaced(double rev, bool home) {
  Bench bench;
  bench.config.joints[0].zero_check = ZeroCheck{0.04, 0.005};
  bench.config.joints[0].home_by_whole_turns = home;
  bench.axes_config.axes[0].zero_rev = rev;
  return bench;
}

TEST(CanPlant, ZeroCheckRefusesToArmAJointWhoseEncodersDisagree) {
  Bench bench = Displaced(0.7, false);
  bench.Start();
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kZero);
  EXPECT_NE(bench.sensors.message.find("zero check"), std::string::npos) << bench.sensors.message;
  bench.plant->ClearFault();
  bench.command.mode[0] = ControlMode::kTorque;
  bench.command.motor_torque_Nm[0] = 0.1;
  bench.Steps(60);
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kZero) << "a reset is no homing";
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kIdle);
}

TEST(CanPlant, ZeroCheckAllowsTheTeethTheirPlay) {
  Bench bench = Displaced(0.3, false);  // 0.019 rad of half 0.04 and 0.005
  bench.Start();
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  bench.Arm();
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, HomingFindsTheWholeTurnsByTheOutputEncoder) {
  for (const double rev : {7.0, -23.0, 4.3}) {
    Bench bench = Displaced(rev, true);
    bench.Start();
    EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
    const double within_a_turn_rad = types::kTwoPi * (rev - std::round(rev));
    EXPECT_NEAR(bench.sensors.motor_position_rad[0],
                100.0 * bench.sensors.position_rad[0] + within_a_turn_rad, 1e-3);
    // A position command means the output's position, whatever the controller counts.
    bench.Arm(ControlMode::kPosition);
    bench.command.position_rad[0] = 0.3;
    bench.Steps(480);
    EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
    EXPECT_NEAR(bench.sensors.motor_position_rad[0] / 100.0, 0.3, 0.01);
  }
}

TEST(CanPlant, AJointsFaultIdlesThatJointOnly) {
  Bench bench({.joints = 3});
  bench.Start();
  bench.Arm();
  for (int j = 0; j < 3; ++j) bench.command.motor_torque_Nm[j] = 0.001;
  bench.Steps(4);
  bench.axes->SetAxisError(1, can::axis_error::kMotorFailed);
  bench.Steps(60);
  EXPECT_FALSE(bench.sensors.fault);
  EXPECT_FALSE(bench.sensors.joint_fault[0]);
  EXPECT_TRUE(bench.sensors.joint_fault[1]);
  EXPECT_FALSE(bench.sensors.joint_fault[2]);
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kClosedLoopControl);
  EXPECT_EQ(bench.axes->input_torque_Nm(1), 0.0);
  EXPECT_NEAR(bench.axes->input_torque_Nm(2), 0.001 * (8.27 / 600) / 0.0159155, 1e-6);
}

TEST(CanPlant, HotMotorIsAFault) {
  Bench bench;
  bench.Start();
  bench.rotors.temperature_degC[0] = 91.0;
  bench.Steps(5);
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kOverTemperature);
}

TEST(CanPlant, CommandThatIsNotFiniteIsAFaultAndMovesNothing) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = std::nan("");
  bench.Steps(3);
  EXPECT_EQ(bench.plant->fault(0), FaultKind::kNotFinite);
  EXPECT_EQ(bench.rotors.torque_Nm[0], 0.0);
}

TEST(CanPlant, AxisThatNeverClosesItsLoopIsAFaultAfterASecondAndGetsNoTorque) {
  const Bench bench({.output_nodes = false});
  can::MemoryBus bus({});
  const auto end = bus.Join("bridge");
  const auto deaf = bus.Join("deaf axis");  // heartbeat and estimates, and takes no orders
  std::int64_t next_ns = kMs_ns;
  bus.AddAgent([&] { return next_ns; },
               [&](std::int64_t now_ns) {
                 (void)deaf->Send(can::Encode(1, can::EncoderEstimates{}));
                 if (now_ns % (100 * kMs_ns) == 0) {
                   (void)deaf->Send(can::Encode(1, can::Heartbeat{0, can::AxisState::kIdle}));
                 }
                 next_ns += kMs_ns;
               });
  bus.OnFrame([](const can::Delivery& d) {
    if (const auto t = can::Decode<can::SetInputTorque>(d.frame)) {
      EXPECT_EQ(t->torque_Nm, 0.0);
    }
  });
  CanPlant plant(bench.config, {end.get()});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  provider::PlantCommand command;
  command.mode[0] = ControlMode::kTorque;
  command.motor_torque_Nm[0] = 0.001;
  const std::int64_t start_ns = bus.now_ns();
  while (plant.fault(0) == FaultKind::kNone && bus.now_ns() < 3'000 * kMs_ns) {
    plant.Step(command, kPeriod_s, &sensors);
    bus.AdvanceTo(bus.now_ns() + kPeriod_ns);
  }
  EXPECT_EQ(plant.fault(0), FaultKind::kNoClosedLoop) << sensors.message;
  EXPECT_NEAR(1e-9 * static_cast<double>(bus.now_ns() - start_ns), 1.0, 0.02);
}

TEST(CanPlant, MissingAxisIsNamedAtTheStart) {
  Bench bench;
  bench.config.joints[0].node = 9;
  try {
    bench.Start();
    FAIL();
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("joint0"), std::string::npos) << text;
    EXPECT_NE(text.find("node 9"), std::string::npos) << text;
    EXPECT_NE(text.find("5.0 s"), std::string::npos) << text;
  }
}

TEST(CanPlant, FramesFromBeforeTheStartAreNotTakenForNews) {
  Bench bench;
  bench.Prepare();
  bench.buses[0]->AdvanceTo(253 * kMs_ns);  // heartbeats and estimates wait in the bridge's socket
  bench.axes->Silence(0, true);
  EXPECT_THROW(bench.plant->Reset(&bench.sensors), std::runtime_error);
}

TEST(CanPlant, ExpiredWatchdogOfAnAxisThatIsJustBeingArmedIsClearedToo) {
  Bench bench({.watchdog_s = 0.02});
  bench.Start();
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 300 * kMs_ns);  // the bridge is kept waiting
  EXPECT_NE(bench.axes->axis_error(0), 0U);
  bench.Arm();  // in the first cycle
  bench.Steps(120);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kClosedLoopControl);
}

TEST(CanPlant, HeartbeatThatCrossedTheClearingIsNoNewFault) {
  Bench bench;
  bench.Start();
  bench.Steps(10);
  const auto axis = bench.buses[0]->Join("axis");
  const can::Frame error =
      can::Encode(1, can::Heartbeat{can::axis_error::kMotorFailed, can::AxisState::kIdle});
  bench.plant->ClearFault();
  ASSERT_EQ(axis->Send(error), can::SendStatus::kOk);  // before the axis took Clear_Errors
  bench.Steps(2);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  bench.Steps(3);
  ASSERT_EQ(axis->Send(error), can::SendStatus::kOk);  // after it
  bench.Steps(2);
  EXPECT_TRUE(bench.faulty());
}

TEST(CanPlant, ExpiredWatchdogOfAnIdleAxisIsClearedAndOfAnActiveOneAFault) {
  Bench bench({.watchdog_s = 0.02});
  bench.Start();
  bench.Steps(10);
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 300 * kMs_ns);  // the bridge is kept waiting
  EXPECT_NE(bench.axes->axis_error(0), 0U);
  bench.Steps(60);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_EQ(bench.axes->axis_error(0), 0U);
  bench.Arm();
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 30 * kMs_ns);
  bench.Steps(60);
  EXPECT_TRUE(bench.faulty());
}

TEST(CanPlant, ErrorsFromBeforeTheStartAreCleared) {
  Bench bench({.watchdog_s = 0.02});  // expires before the bridge speaks for the first time
  bench.buses[0]->AdvanceTo(500 * kMs_ns);
  bench.Start();
  bench.Steps(30);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_EQ(bench.axes->axis_error(0), 0U);
}

TEST(CanPlant, ValvesFollowTheCommandAndShutWhenTheBridgeDies) {
  Bench bench;
  bench.Start();
  bench.command.valve_open[0] = true;
  bench.command.compressor_on[0] = true;
  bench.Steps(3);
  EXPECT_TRUE(bench.rotors.last_command.valve_open[0]);
  EXPECT_TRUE(bench.rotors.last_command.compressor_on[0]);
  EXPECT_FALSE(bench.rotors.last_command.vent_open[0]);
  EXPECT_TRUE(bench.sensors.valve_open[0]) << "as the node reads it back";
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 70 * kMs_ns);
  EXPECT_FALSE(bench.rotors.last_command.valve_open[0]);
  EXPECT_FALSE(bench.rotors.last_command.compressor_on[0]);
}

TEST(CanPlant, RequestedEstimatesAreOfThisCycle) {
  Bench bench({.estimates = Estimates::kRequested});
  bench.axes_config.step_s = 0.0002;
  bench.axes_config.nodes[0].encoder_ms = 1;
  bench.axes_config.nodes[0].sensors_ms = 1;
  bench.Start();
  bench.Steps(20);
  for (int i = 0; i < 100; ++i) {
    bench.Step();
    ASSERT_LT(bench.sensors.age_us[0], 1500);
  }
}

TEST(CanPlant, ActSendsAtOnceAndTheStepAfterItOnlyReads) {
  Bench bench;
  bench.Start();
  bench.Arm();
  int setpoints = 0;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (can::Decode<can::SetInputTorque>(d.frame)) ++setpoints;
  });
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.plant->Act(bench.command, kPeriod_s);
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 2 * kMs_ns);
  EXPECT_EQ(setpoints, 1);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.001, 1e-9);
  bench.Step();
  EXPECT_EQ(setpoints, 1);
  bench.Step();
  EXPECT_EQ(setpoints, 2) << "without Act, Step sends";
}

// Whatever comes over the bus, forged answers of our own axes included: no setpoint beyond the
// limits, none that is not finite, none to a joint that was not told to move.
// SINEW_FUZZ_FRAMES=100000000 makes a long run of it.
TEST(CanPlant, FuzzedFramesNeverMakeASetpointBeyondTheLimitsNorToAnotherJoint) {
  const char* text = std::getenv("SINEW_FUZZ_FRAMES");
  const long frames = text == nullptr ? 300'000 : std::atol(text);
  const Bench bench({.joints = 3});
  Deaf bus;
  for (int node = 1; node <= 3; ++node) {
    bus.frames.push_back(can::Encode(node, can::Heartbeat{0, can::AxisState::kClosedLoopControl}));
    bus.frames.push_back(can::Encode(node, can::EncoderEstimates{}));
    bus.frames.push_back(can::Encode(node + 32, can::OutputEncoder{0.25, 0, 0, true}));
    bus.frames.push_back(can::Encode(node + 32, can::JointSensors{}));
  }
  CanPlant plant(bench.config, {&bus});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  const double most_Nm = 0.398 * (8.27 / 600) / test::Rotors::kTorqueConstant_Nm_A * (1.0 + 1e-6);
  long moved = 0, wrong = 0;
  bus.on_send = [&](const can::Frame& frame) {
    const int node = can::AddressOf(frame)->node;
    if (node < 1 || (node > 3 && node < 33) || node > 35) ++wrong;
    if (const auto t = can::Decode<can::SetInputTorque>(frame)) {
      if (!(std::abs(t->torque_Nm) <= most_Nm)) ++wrong;
      if (t->torque_Nm != 0.0) {
        ++moved;
        if (node != 2) ++wrong;  // only the second joint is told to move
      }
    }
    if (const auto p = can::Decode<can::SetInputPos>(frame); p && node != 2) ++wrong;
  };
  std::mt19937 random(29);
  provider::PlantCommand command;
  const std::vector<can::Frame> good = bus.frames;
  std::uint8_t sequence = 0;
  for (long sent = 0; sent < frames;) {
    bus.frames = good;  // the axes are alive, so that there is something to move
    ++sequence;
    for (can::Frame& frame : bus.frames) {
      if (can::DecodeOutputEncoder(frame) && can::AddressOf(frame)->node > 32)
        frame.data[6] = sequence;
    }
    for (int i = 0; i < 30; ++i, ++sent) {
      can::Frame frame;
      const bool ours = random() % 2 == 0;
      frame.id = ours ? ((random() % 3 + (random() % 2 == 0 ? 1 : 33)) << 5 | random() % 32)
                      : random() & 0x7FF;
      frame.remote = random() % 16 == 0;
      frame.extended = random() % 16 == 0;
      frame.error = random() % 16 == 0;
      frame.length = static_cast<std::uint8_t>(random() % 10);
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
      bus.frames.push_back(frame);
    }
    std::shuffle(bus.frames.begin(), bus.frames.end(), random);
    bus.next = 0;
    bus.now += kPeriod_ns;
    command.mode[1] = random() % 8 == 0 ? ControlMode::kPosition : ControlMode::kTorque;
    command.motor_torque_Nm[1] =
        1e-3 * static_cast<double>(static_cast<int>(random() % 2001) - 1000);
    command.position_rad[1] = 1e-3 * static_cast<double>(static_cast<int>(random() % 4001) - 2000);
    plant.Step(command, kPeriod_s, &sensors);
    if (sent % 3000 < 30) plant.ClearFault();  // the operator who never gives up
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(moved, 0) << "the test must reach the setpoints";
  EXPECT_GT(plant.malformed(), 0U);
}

TEST(CanPlant, ActAndStepTakeNothingFromTheHeap) {
  const Bench bench;
  Deaf bus;
  bus.frames = {can::Encode(1, can::Heartbeat{0, can::AxisState::kClosedLoopControl}),
                can::Encode(1, can::EncoderEstimates{0.1, 0.2}), can::Encode(1, can::Iq{0.1, 0.2}),
                can::Encode(33, can::OutputEncoder{0.25, 0, 0, true}),
                can::Encode(33, can::JointSensors{})};
  CanPlant plant(bench.config, {&bus});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  provider::PlantCommand command;
  command.mode[0] = ControlMode::kTorque;
  command.motor_torque_Nm[0] = 0.001;
  const long before = test::Allocations();
  for (int i = 0; i < 500; ++i) {
    bus.now += kPeriod_ns;
    bus.next = 0;
    bus.frames[3].data[6]++;  // its sequence number
    plant.Act(command, kPeriod_s);
    plant.Step(command, kPeriod_s, &sensors);
  }
  EXPECT_EQ(test::Allocations() - before, 0);
  EXPECT_FALSE(sensors.any_fault()) << sensors.message;
}

TEST(CanPlant, OldFirmwareWorksAsWell) {
  Bench bench;
  bench.config.joints[0].firmware = bench.axes_config.axes[0].firmware = can::Firmware::k0_5_1;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Steps(5);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.001, 1e-9);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, TwelveJointsOnTwoBusesRunFaultlessAndEachMovesItsOwn) {
  Bench bench({.joints = 12, .buses = 2});
  for (auto& node : bench.axes_config.nodes) node.sensors_ms = 20;
  bench.config.timing.estimate_timeout_s = 0.03;
  bench.config.timing.iq_every_cycles = 4;
  for (auto& axis : bench.axes_config.axes) axis.rates.encoder_ms = 4;
  bench.Start();
  bench.Arm();
  for (std::size_t j = 0; j < 12; ++j)
    bench.command.motor_torque_Nm[j] = 1e-4 * (static_cast<double>(j) - 5.5);
  bench.Steps(240);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  for (std::size_t j = 0; j < 12; ++j) {
    EXPECT_NEAR(bench.rotors.torque_Nm[j], bench.command.motor_torque_Nm[j], 1e-9) << j;
    EXPECT_NEAR(bench.sensors.position_rad[j], bench.rotors.angle_rad[j] / 100.0, 0.02) << j;
    EXPECT_TRUE(bench.sensors.valid[j]) << j;
  }
  const provider::BusReport& report = *bench.plant->bus_report();
  EXPECT_EQ(report.bus_count, 2);
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_TRUE(report.up[b]);
    EXPECT_EQ(report.frames_dropped[b], 0U);
    EXPECT_GT(report.load_percent[b], 20.0);
    EXPECT_LT(report.load_percent[b], 100.0);
  }
}

// One axis, an idle bus: the question's and the answer's bit times, and up to a step of the axis.
TEST(CanPlant, AnswersAreTimedFromTheirQuestion) {
  Bench bench({.output_nodes = false});
  bench.Start();
  EXPECT_EQ(bench.plant->bus_report()->answer_max_us[0], 0.0);
  bench.Steps(500);
  const provider::BusReport& report = *bench.plant->bus_report();
  const int question = can::FrameBits(can::EncodeRequest(1, can::Command::kGetIq));
  EXPECT_GT(report.answer_p50_us[0], question + 8 * 8 + 47);
  EXPECT_LT(report.answer_max_us[0], 1000.0 + 4 * 135.0);
  EXPECT_GE(report.answer_max_us[0], report.answer_p50_us[0]);
  Bench quiet({.output_nodes = false});
  quiet.config.timing.iq_every_cycles = 0;
  quiet.Start();
  quiet.Steps(600);  // beyond the start, which asks for estimates
  EXPECT_EQ(quiet.plant->bus_report()->answer_p50_us[0], 0.0) << "nothing was asked";
}

TEST(CanPlant, LoadIsTheBusTimeOfTheFrames) {
  Bench bench;
  bench.Start();
  const auto busy = [&] { return bench.buses[0]->model().counters().busy_ns; };
  bench.Steps(245);
  const std::int64_t before = busy();
  const std::int64_t start = bench.buses[0]->now_ns();
  bench.Steps(480);
  const double percent = 100.0 * static_cast<double>(busy() - before) /
                         static_cast<double>(bench.buses[0]->now_ns() - start);
  EXPECT_NEAR(bench.plant->bus_report()->load_percent[0], percent, 0.05 * percent);
}

TEST(CanPlant, NoiseOfForeignAndBrokenFramesMovesNoJointAndIsNoFault) {
  Bench bench;
  bench.Start();
  bench.Arm();
  const auto noise = bench.buses[0]->Join("noise");
  std::mt19937 random(23);
  for (int cycle = 0; cycle < 1000; ++cycle) {
    for (int i = 0; i < 5; ++i) {
      can::Frame frame;
      frame.extended = random() % 4 == 0;
      frame.id = random() & (frame.extended ? can::kMaxExtendedId : can::kMaxStandardId);
      // Not in the names of our nodes: that is no noise but an impostor.
      if (!frame.extended && (frame.id >> 5 == 1 || frame.id >> 5 == 33)) continue;
      frame.length = static_cast<std::uint8_t>(random() % 9);
      for (std::size_t k = 0; k < frame.length; ++k)
        frame.data[k] = static_cast<std::uint8_t>(random());
      (void)noise->Send(frame);
    }
    bench.Step();
  }
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_EQ(bench.rotors.angle_rad[0], 0.0);
}

TEST(CanPlant, TruncatedAndNonFiniteAnswersAreCountedAndNotBelieved) {
  Bench bench;
  bench.Start();
  bench.Steps(5);
  const auto forger = bench.buses[0]->Join("forger");
  can::Frame cut = can::Encode(1, can::EncoderEstimates{50.0, 0.0});
  cut.length = 7;
  cut.data[7] = 0;
  ASSERT_EQ(forger->Send(cut), can::SendStatus::kOk);
  ASSERT_EQ(forger->Send(can::Encode(1, can::EncoderEstimates{std::nan(""), 0.0})),
            can::SendStatus::kOk);
  bench.Steps(2);
  EXPECT_EQ(bench.plant->malformed(), 2U);
  EXPECT_NEAR(bench.sensors.motor_position_rad[0], 0.0, 1e-9);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, FiltersLetThroughExactlyWhatIsRead) {
  Bench bench;
  const auto filters = ReceiveFilters(bench.config, 0);
  int passed = 0;
  for (std::uint32_t id = 0; id <= can::kMaxStandardId; ++id) {
    can::Frame frame;
    frame.id = id;
    if (can::Passes(filters, frame)) {
      ++passed;
      EXPECT_TRUE(id >> 5 == 1 || id >> 5 == 33);
    }
  }
  EXPECT_EQ(passed, 9);
  EXPECT_TRUE(ReceiveFilters(bench.config, 1).empty());
}

TEST(CanPlant, LongRunKeepsStepAndFaultless) {
  Bench bench;
  bench.Start();
  bench.Arm();
  for (int i = 0; i < 240 * 120; ++i) {
    bench.command.motor_torque_Nm[0] = -2e-3 * bench.sensors.motor_position_rad[0] / 10.0 +
                                       5e-4 * std::sin(0.01 * i) -
                                       1e-4 * bench.sensors.motor_velocity_rad_s[0];
    bench.Step();
    ASSERT_FALSE(bench.faulty()) << i << " " << bench.sensors.message;
    ASSERT_TRUE(bench.sensors.valid[0]) << i;
  }
  EXPECT_EQ(bench.plant->malformed(), 0U);
}

TEST(CanPlantConfig, BadValuesAreRefusedWithTheJointsName) {
  can::MemoryBus bus({});
  const auto end = bus.Join("bridge");
  const Bench bench;
  const auto refuse = [&](const std::function<void(BridgeConfig&)>& spoil) {
    BridgeConfig config = bench.config;
    spoil(config);
    try {
      CanPlant(config, {end.get()});
      ADD_FAILURE() << "accepted";
    } catch (const std::invalid_argument& error) {
      if (!config.joints.empty() && config.bitrate_bit_s.size() == 1) {
        EXPECT_NE(std::string(error.what()).find("joint0"), std::string::npos) << error.what();
      }
    }
  };
  EXPECT_NO_THROW(CanPlant(bench.config, {end.get()}));
  refuse([](BridgeConfig& c) { c.joints.clear(); });
  refuse([](BridgeConfig& c) { c.bitrate_bit_s.clear(); });
  refuse([](BridgeConfig& c) { c.joints[0].node = 64; });
  refuse([](BridgeConfig& c) { c.joints[0].bus = 1; });
  refuse([](BridgeConfig& c) { c.joints[0].direction = 2; });
  refuse([](BridgeConfig& c) { c.joints[0].gear_ratio = 0.0; });
  refuse([](BridgeConfig& c) { c.joints[0].torque_constant_Nm_A = -1.0; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.motor_torque_Nm = 0.0; });
  refuse([](BridgeConfig& c) { c.joints[0].limits.lower_rad = 2.0; });
  refuse([](BridgeConfig& c) { c.joints[0].output->node = c.joints[0].node; });
  refuse([](BridgeConfig& c) { c.joints[0].zero_check = ZeroCheck{0.04, 0.0}; });
  refuse([](BridgeConfig& c) { c.joints[0].home_by_whole_turns = true; });
  refuse([](BridgeConfig& c) {  // 0.72 of a turn
    c.joints[0].zero_check = ZeroCheck{0.08, 0.005};
    c.joints[0].home_by_whole_turns = true;
  });
  refuse([](BridgeConfig& c) {
    c.joints[0].zero_check = ZeroCheck{0.04, 0.005};
    c.joints[0].output.reset();
  });
}

}  // namespace
}  // namespace sinew::bridge
