// Faults of a joint and their reset against virtual controllers on a bus in memory.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/plant_bench.h"

namespace sinew::bridge {
namespace {

using types::FaultCause;

TEST(CanPlant, NoSetpointLeavesForAnAxisThatHasJustReportedAnError) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Steps(5);
  bench.axes->SetAxisError(0, can::axis_error::kOverTemp);
  bool reported = false;
  int moving = 0;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (const auto h = can::Decode<can::Heartbeat>(d.frame); h && h->axis_error != 0)
      reported = true;
    const auto torque = can::Decode<can::SetInputTorque>(d.frame);
    if (reported && torque && torque->torque_Nm != 0.0) ++moving;
  });
  bench.Steps(60);
  EXPECT_TRUE(reported);
  EXPECT_EQ(moving, 0);
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
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kOutOfRange) << bench.sensors.message;
}

// Another end of the bus that sends `frame` every 4 ms from now on.
std::unique_ptr<can::Transport> Repeat(Bench* bench, const can::Frame& frame) {
  std::unique_ptr<can::Transport> end = bench->buses[0]->Join("another master");
  const auto next_ns = std::make_shared<std::int64_t>(bench->buses[0]->now_ns());
  bench->buses[0]->AddAgent([next_ns] { return *next_ns; },
                            [next_ns, frame, sender = end.get()](std::int64_t now_ns) {
                              *next_ns = now_ns + 4'000'000;
                              (void)sender->Send(frame);
                            });
  return end;
}

TEST(AnotherMaster, IsAFaultOfTheJointThatItCommandsAndIdlesIt) {
  const can::Frame frames[] = {
      can::Encode(1, can::SetInputTorque{0.0}), can::Encode(1, can::SetInputVel{0.0, 0.0}),
      can::Encode(1, can::SetInputPos{0.0, 0.0, 0.0}),
      can::Encode(1, can::SetAxisState{can::AxisState::kIdle}),
      can::Encode(1,
                  can::SetControllerMode{can::ControlMode::kTorque, can::InputMode::kPassthrough})};
  for (const can::Frame& frame : frames) {
    Bench bench({.joints = 2});
    bench.Start();
    bench.Arm();
    const auto other = Repeat(&bench, frame);
    bench.Steps(20);
    EXPECT_EQ(bench.plant->fault(0), FaultCause::kAnotherMaster) << frame.id;
    EXPECT_EQ(bench.plant->fault(1), FaultCause::kNone) << frame.id;
    EXPECT_NE(bench.sensors.message.find("another master"), std::string::npos);
    EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kIdle) << frame.id;
  }
}

TEST(AnotherMaster, OfAGatewayIsAFaultOfEveryJointBehindIt) {
  Bench bench({.joints = 2, .output_nodes = false, .gateway = true});
  bench.Start();
  const auto other = Repeat(&bench, can::EncodeReferences(Bench::kGatewayNode, {})[0]);
  bench.Steps(5);
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kAnotherMaster);
  EXPECT_EQ(bench.plant->fault(1), FaultCause::kAnotherMaster);
}

TEST(AnotherMaster, OnTheBusBeforeUsGetsNotAFrameFromUs) {
  Bench bench;
  bench.Prepare();
  const auto other = Repeat(&bench, can::Encode(1, can::SetInputTorque{0.0}));
  EXPECT_THROW(bench.plant->Reset(&bench.sensors), std::runtime_error);
  bench.plant->ShutDown();
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 5'000'000);
  EXPECT_EQ(bench.ends[0]->counters().sent, 0U);
}

TEST(AnotherMaster, AFrameThatIsTooShortIsNone) {
  can::Frame frame = can::Encode(1, can::SetInputTorque{0.5});
  frame.length = 3;
  Bench bench;
  bench.Start();
  bench.Arm();
  const auto other = Repeat(&bench, frame);
  bench.Steps(20);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(AnotherMaster, OfOtherNodesIsNone) {
  Bench bench;
  bench.Start();
  bench.Arm();
  const auto other = Repeat(&bench, can::Encode(9, can::SetInputTorque{0.5}));
  bench.Steps(20);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, AxisErrorIsAFaultWithItsNameAndItsCauseAndClearsByReset) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.axes->SetAxisError(0, can::axis_error::kOverTemp);
  bench.Steps(40);
  EXPECT_TRUE(bench.faulty());
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kAxisError);
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
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kEstimatesLost) << bench.sensors.message;
  EXPECT_GT(bench.sensors.age_us[0], 60'000);
}

TEST(CanPlant, BusThatIsOffIsNamedInTheFault) {
  Bench bench({.output_nodes = false});
  bench.Start();
  bench.Steps(5);
  // A second node with the bridge's identifiers and other content, until both are bus-off.
  const auto second_node = bench.buses[0]->Join("second_node");
  for (int i = 0; i < 600 && bench.plant->fault(0) == FaultCause::kNone; ++i) {
    (void)second_node->Send(can::Trim(can::Encode(1, can::SetInputTorque{0.5})));
    bench.Step();
  }
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kEstimatesLost);
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
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kHeartbeatLost) << bench.sensors.message;
}

TEST(CanPlant, JumpOfTheMotorEncoderIsAFaultOfThatJoint) {
  Bench bench({.joints = 2});
  bench.Start();
  bench.Steps(10);
  bench.rotors.angle_rad[1] += 0.5 * types::kTwoPi;
  bench.Steps(3);
  EXPECT_EQ(bench.plant->fault(1), FaultCause::kEncoderJump) << bench.sensors.message;
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kNone);
  EXPECT_TRUE(bench.faulty());
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
  EXPECT_FALSE(bench.sensors.joint_fault[0].active());
  EXPECT_TRUE(bench.sensors.joint_fault[1].active());
  EXPECT_FALSE(bench.sensors.joint_fault[2].active());
  EXPECT_EQ(bench.axes->axis_state(0), can::AxisState::kClosedLoopControl);
  EXPECT_EQ(bench.axes->input_torque_Nm(1), 0.0);
  EXPECT_NEAR(bench.axes->input_torque_Nm(2), 0.001 * (8.27 / 600) / 0.0159155, 1e-6);
}

TEST(CanPlant, HotMotorIsAFault) {
  Bench bench;
  bench.Start();
  bench.rotors.temperature_degC[0] = 91.0;
  bench.Steps(5);
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kOverTemperature);
}

TEST(CanPlant, CommandThatIsNotFiniteIsAFaultAndMovesNothing) {
  Bench bench;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = std::nan("");
  bench.Steps(3);
  EXPECT_EQ(bench.plant->fault(0), FaultCause::kNotFinite);
  EXPECT_EQ(bench.rotors.torque_Nm[0], 0.0);
}

}  // namespace
}  // namespace sinew::bridge
