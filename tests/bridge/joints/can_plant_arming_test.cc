// Arming, homing, start and end of the bridge against virtual controllers on a bus in memory.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/plant_bench.h"

namespace sinew::bridge {
namespace {

using types::FaultCause;

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
  ASSERT_EQ(bench.plant->fault(0), FaultCause::kNotFinite);
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
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kZero);
  EXPECT_NE(bench.sensors.message.find("zero check"), std::string::npos) << bench.sensors.message;
  bench.plant->ClearFault();
  bench.command.mode[0] = ControlMode::kTorque;
  bench.command.motor_torque_Nm[0] = 0.1;
  bench.Steps(60);
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kZero) << "a reset is no homing";
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
  while (plant.fault(0) == FaultCause::kNone && bus.now_ns() < 3'000 * kMs_ns) {
    plant.Step(command, kPeriod_s, &sensors);
    bus.AdvanceTo(bus.now_ns() + kPeriod_ns);
  }
  EXPECT_EQ(plant.fault(0), FaultCause::kNoClosedLoop) << sensors.message;
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
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 300 * kMs_ns);  // the bridge is delayed
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
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 300 * kMs_ns);  // the bridge is delayed
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
  Bench bench({.watchdog_s = 0.02});  // expires before the first frame of the bridge
  bench.buses[0]->AdvanceTo(500 * kMs_ns);
  bench.Start();
  bench.Steps(30);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_EQ(bench.axes->axis_error(0), 0U);
}

}  // namespace
}  // namespace sinew::bridge
