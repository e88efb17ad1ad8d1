// Real processes: sinew-can-bus, sinew-virtual-axes with the surrogate behind them,
// sinew-can-bridge; this test plays control and operator over DDS. Domains 90-98.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/bridge/participant/can_rig.h"

namespace sinew {
namespace {

TEST(CanBridgeSystem, TorqueMovesTheLinkThroughFramesAndTheStateComesBack) {
  Rig rig(90);
  ASSERT_TRUE(rig.Run(0.0, seconds(20), [](const msg::JointState& s) { return s.valid[0]; }))
      << rig.bridge().error() << rig.axes().error();
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kDisarmed);
  EXPECT_EQ(rig.last().header.origin, msg::Origin::kSim);
  EXPECT_EQ(rig.last().joint_count, 1);
  const double start_rad = rig.last().position_rad[0];

  // Disarmed: a torque moves nothing.
  std::uint64_t until = rig.last().header.tick + 60;
  ASSERT_TRUE(
      rig.Run(0.1, seconds(10), [&](const msg::JointState& s) { return s.header.tick > until; }));
  EXPECT_NEAR(rig.last().position_rad[0], start_rad, 0.005);

  ASSERT_TRUE(rig.Arm()) << rig.bridge().error();
  // 0.04 Nm at the motor are 3.1 Nm at the output: more than the 1.2 Nm that hold the rested link.
  EXPECT_TRUE(rig.Run(0.04, seconds(10),
                      [&](const msg::JointState& state) {
                        return state.position_rad[0] > start_rad + 0.05 &&
                               state.velocity_rad_s[0] > 0.0 && state.torque_Nm[0] > 1.0 &&
                               rig.actuator() &&
                               std::abs(rig.actuator()->motor_current_A[0] - 0.04 / 0.0159155) <
                                   0.3;
                      }))
      << rig.last().position_rad[0] << rig.bridge().error();
  EXPECT_NEAR(rig.actuator()->motor_position_rad[0] / 100.0, rig.last().position_rad[0], 0.06)
      << "but for the play";
  EXPECT_GT(rig.actuator()->chamber_pressure_bar[0], 0.5);
  EXPECT_TRUE(rig.actuator()->valve_open[0]);
  EXPECT_GT(rig.actuator()->motor_temperature_degC[0], 15.0);

  // The valve follows its command.
  rig.valve_open = false;
  EXPECT_TRUE(rig.Run(0.0, seconds(10), [&](const msg::JointState&) {
    return rig.actuator() && !rig.actuator()->valve_open[0];
  }));
  // It does not follow what comes late.
  rig.late_valve_open = true;
  const std::uint64_t late_until = rig.last().header.tick + 60;
  EXPECT_TRUE(rig.Run(0.0, seconds(10), [&](const msg::JointState& s) {
    EXPECT_FALSE(rig.actuator()->valve_open[0]) << s.header.tick;
    return s.header.tick > late_until;
  }));
  rig.late_valve_open.reset();

  rig.Operator(msg::OperatorAction::kDisarm);
  EXPECT_TRUE(rig.Run(0.0, seconds(10), [](const msg::JointState& s) {
    return s.robot_state == msg::RobotState::kDisarmed;
  })) << rig.bridge().error();

  ASSERT_TRUE(rig.Run(0.0, seconds(10), [&](const msg::JointState&) {
    return rig.status() && rig.status()->load_percent[0] > 0.0;
  })) << "the load is reported once a second";
  EXPECT_EQ(rig.status()->bus_count, 1);
  EXPECT_TRUE(rig.status()->up[0]);
  EXPECT_EQ(rig.status()->error_frames[0], 0U);
  EXPECT_GT(rig.status()->load_percent[0], 5.0);
  EXPECT_LT(rig.status()->load_percent[0], 60.0);
  EXPECT_GT(rig.status()->answer_p50_us[0], 150.0) << "two frames at 1 Mbit/s";
  EXPECT_GE(rig.status()->answer_max_us[0], rig.status()->answer_p50_us[0]);
  RecordProperty("bus_load_percent", std::to_string(rig.status()->load_percent[0]));
  RecordProperty("cycle_p50_us", std::to_string(rig.status()->cycle_p50_us));

  // The log has the torque setpoint as a frame: 0.04 Nm of the motor are 0.0346411 Nm of the
  // controller.
  rig.bridge().Signal(SIGTERM);
  EXPECT_EQ(rig.bridge().Wait(seconds(10)), 0);

  // 0.04 Nm of the motor are 0.04 * 0.0137833 / 0.0159155 = 0.0346411 Nm of the controller.
  const std::string frames = ReadText(rig.log());
  EXPECT_NE(frames.find(" 06E#"), std::string::npos);
  EXPECT_NE(frames.find(" 06E#" + Setpoint(0.04 * 0.0137833 / 0.0159155)), std::string::npos);
}

TEST(CanBridgeSystem, DeadControllersAreAFaultThatOnlyAnOperatorEnds) {
  Rig rig(91);
  ASSERT_TRUE(rig.Run(0.0, seconds(20), [](const msg::JointState& s) { return s.valid[0]; }));
  ASSERT_TRUE(rig.Arm());
  rig.axes().Signal(SIGKILL);
  EXPECT_TRUE(rig.Run(0.0, seconds(10), [](const msg::JointState& s) {
    return s.robot_state == msg::RobotState::kFault && !s.valid[0];
  })) << rig.bridge().error();
  // Estimates or the sensor node, whichever timed out first.
  EXPECT_TRUE(rig.bridge().WaitForText("fault: joint 'joint' (node 3): no", seconds(5)))
      << rig.bridge().error();

  // They come back, and nothing moves until it was reset and armed.
  rig.StartAxes();
  ASSERT_TRUE(rig.Run(0.04, seconds(15), [](const msg::JointState& s) { return s.valid[0]; }));
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kFault);
  const double rest_rad = rig.last().position_rad[0];
  const std::uint64_t until = rig.last().header.tick + 60;
  ASSERT_TRUE(
      rig.Run(0.04, seconds(10), [&](const msg::JointState& s) { return s.header.tick > until; }));
  EXPECT_NEAR(rig.last().position_rad[0], rest_rad, 0.005);
  ASSERT_TRUE(rig.Run(0.0, seconds(15), [&rig, k = 0](const msg::JointState& s) mutable {
    if (k++ % 50 == 0) rig.Operator(msg::OperatorAction::kReset);
    return s.robot_state == msg::RobotState::kDisarmed;
  })) << rig.bridge().error();
  EXPECT_TRUE(rig.Arm()) << rig.bridge().error();
}

TEST(CanBridgeSystem, KilledBridgeLeavesTheMotorIdleByTheControllersWatchdog) {
  Rig rig(92);
  ASSERT_TRUE(rig.Run(0.0, seconds(20), [](const msg::JointState& s) { return s.valid[0]; }));
  ASSERT_TRUE(rig.Arm());
  ASSERT_TRUE(
      rig.Run(0.02, seconds(5), [](const msg::JointState& s) { return s.torque_Nm[0] > 0.5; }));
  rig.bridge().Signal(SIGKILL);
  (void)rig.bridge().Wait(seconds(5));
  // A new bridge finds the axis idle, clears its error, and stays disarmed.
  rig.StartBridge();
  const std::uint64_t session = rig.last().header.session_id;
  ASSERT_TRUE(rig.Run(0.02, seconds(20), [&](const msg::JointState& s) {
    return s.header.session_id != session && s.valid[0];
  })) << rig.bridge().error();
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kDisarmed) << rig.bridge().error();
  EXPECT_NEAR(rig.last().torque_Nm[0], 0.0, 0.3) << "noise of the current sensor, times the gear";
  EXPECT_NE(ReadText(rig.log()).find(" 061#00080000"), std::string::npos)
      << "the axis reported the expiry of its watchdog";
}

// Ended by the signal while a torque moves the joint.
void IdlesBeforeItEnds(int signal) {
  Rig rig(98);
  ASSERT_TRUE(rig.Run(0.0, seconds(20), [](const msg::JointState& s) { return s.valid[0]; }));
  ASSERT_TRUE(rig.Arm());
  ASSERT_TRUE(
      rig.Run(0.02, seconds(5), [](const msg::JointState& s) { return s.torque_Nm[0] > 0.5; }));
  rig.bridge().Signal(signal);
  EXPECT_EQ(rig.bridge().Wait(seconds(10)), 0) << rig.bridge().error();
  const std::string frames = ReadText(rig.log());
  const std::size_t idle = frames.rfind(" 067#01000000");  // Set_Axis_State, IDLE
  ASSERT_NE(idle, std::string::npos);
  EXPECT_GT(idle, frames.rfind(" 067#08000000")) << "closed loop was asked before";
  EXPECT_EQ(frames.find(" 06E#", idle), std::string::npos) << "no setpoint after it";
}

TEST(CanBridgeSystem, AHangUpIdlesTheMotorBeforeTheBridgeEnds) { IdlesBeforeItEnds(SIGHUP); }

TEST(CanBridgeSystem, AQuitOfTheTerminalIdlesTheMotorBeforeTheBridgeEnds) {
  IdlesBeforeItEnds(SIGQUIT);
}

TEST(CanBridgeSystem, WhenOneJointFailsTheOtherHoldsAsDeclared) {
  Rig rig(95, {.second_joint = true, .rest = "hold"});
  ASSERT_TRUE(rig.Run(
      0.0, seconds(20),
      [](const msg::JointState& s) { return s.joint_count == 2 && s.valid[0] && s.valid[1]; }))
      << rig.bridge().error() << rig.axes().error();
  ASSERT_TRUE(rig.Arm());
  // Both follow: their setpoints are of this torque.
  const std::string follows = "#" + Setpoint(0.001 * 0.0137833 / 0.0159155);
  ASSERT_TRUE(rig.Run(0.001, seconds(10), [&](const msg::JointState&) {
    const std::string frames = ReadText(rig.log());
    return frames.find(" 06E" + follows) != std::string::npos &&
           frames.find(" 08E" + follows) != std::string::npos;
  })) << rig.bridge().error();

  can::VirtualCan other({.bus = rig.bus_path()});
  ASSERT_EQ(other.Send(can::Encode(4, can::Estop{}, can::Firmware::k0_5_6)), can::SendStatus::kOk);
  ASSERT_TRUE(rig.Run(0.001, seconds(10), [](const msg::JointState& s) {
    return s.robot_state == msg::RobotState::kFault;
  }));
  EXPECT_TRUE(rig.bridge().WaitForText("joint 'second' (node 4): axis error", seconds(5)))
      << rig.bridge().error();
  // From the first's first position on it gets positions, the second nothing but a torque of
  // nothing.
  std::string since;
  ASSERT_TRUE(rig.Run(0.001, seconds(10), [&](const msg::JointState&) {
    const std::string frames = ReadText(rig.log());
    const std::size_t hold = frames.find(" 06C#");
    if (hold == std::string::npos) return false;
    since = frames.substr(hold);
    return std::count(since.begin(), since.end(), '\n') > 500;
  })) << "positions of the first";
  EXPECT_EQ(since.find(" 06E#"), std::string::npos) << "no torque of the first";
  EXPECT_EQ(since.find(" 08C#"), std::string::npos) << "no position of the second";
  EXPECT_NE(since.find(" 08E#00000000"), std::string::npos);
  EXPECT_EQ(since.find(follows), std::string::npos);

  // The operator lets go.
  rig.Operator(msg::OperatorAction::kDisarm);
  EXPECT_TRUE(rig.Run(0.001, seconds(10), [&](const msg::JointState&) {
    const std::string frames = ReadText(rig.log());
    return frames.find(" 067#01000000", frames.find(" 06C#")) != std::string::npos;
  })) << "the first is requested to idle";
}

// The compact exchange as a way to run the bridge: references out, states in, forces and IMU as
// topics.
TEST(CanBridgeSystem, GatewayCarriesReferencesAndStates) {
  Rig rig(96, {.gateway = true});
  node::Options options;
  options.component = options.name = "listener";
  options.domain_id = 96;
  node::Node listener(options);
  auto feet = listener.MakeReader(node::kFootForce);
  auto imu = listener.MakeReader(node::kImu);
  ASSERT_TRUE(rig.Run(0.0, seconds(20), [](const msg::JointState& s) { return s.valid[0]; }))
      << rig.bridge().error() << rig.axes().error();
  const double start_rad = rig.last().position_rad[0];
  rig.position_rad = start_rad;
  ASSERT_TRUE(rig.Arm()) << rig.bridge().error();
  rig.position_rad = start_rad + 0.3;
  EXPECT_TRUE(rig.Run(0.0, seconds(15),
                      [&](const msg::JointState& s) {
                        return std::abs(s.position_rad[0] - start_rad - 0.3) < 0.05;
                      }))
      << rig.last().position_rad[0] << rig.bridge().error();
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kArmed) << rig.bridge().error();
  bool forces = false, body = false;
  EXPECT_TRUE(rig.Run(0.0, seconds(10), [&](const msg::JointState&) {
    while (const auto message = feet.TakeNext()) forces = forces || message->valid[0];
    while (const auto message = imu.TakeNext()) body = body || message->valid;
    return forces && body;
  })) << "foot_force and imu";
  // On the bus: references 0x601-0x603, states 0x604-0x611; of the axis itself only the measured
  // position in front of each change to position control (a late command damps in between).
  const std::string frames = ReadText(rig.log());
  EXPECT_NE(frames.find(" 611#"), std::string::npos);
  const auto count = [&frames](const std::string& text) {
    int found = 0;
    for (std::size_t at = frames.find(text); at != std::string::npos;
         at = frames.find(text, at + 1))
      ++found;
    return found;
  };
  const int to_position_control = count(" 06B#0300000001000000");
  EXPECT_GE(to_position_control, 1);
  EXPECT_NEAR(count(" 06C#"), to_position_control, 1) << "one in front of each; the log goes on";
  EXPECT_GT(count(" 601#"), 5 * to_position_control);
  EXPECT_EQ(frames.find(" 069#"), std::string::npos) << "estimates of its own";
}

// The world instead of the surrogate behind the same axes.
TEST(CanBridgeSystem, AWorldBehindTheAxesFollowsAPosition) {
  Rig rig(97, {.world = true});
  ASSERT_TRUE(rig.Run(0.0, seconds(20), [](const msg::JointState& s) { return s.valid[0]; }))
      << rig.bridge().error() << rig.axes().error();
  const double start_rad = rig.last().position_rad[0];
  EXPECT_NEAR(start_rad, -1.2, 0.1) << "as its file says";
  rig.position_rad = start_rad;
  ASSERT_TRUE(rig.Arm()) << rig.bridge().error();
  EXPECT_TRUE(rig.Run(0.0, seconds(15),
                      [&](const msg::JointState& s) {
                        // Slowly: the command leads the link by a little.
                        rig.position_rad = std::min(start_rad + 0.3, s.position_rad[0] + 0.05);
                        return s.position_rad[0] > start_rad + 0.2;
                      }))
      << rig.last().position_rad[0] << rig.bridge().error();
  EXPECT_EQ(rig.last().robot_state, msg::RobotState::kArmed) << rig.bridge().error();
}

// The whole deployment: the control test of the rig through frames. Domain 94.
TEST(CanBridgeSystem, DeploymentOfTheRigBehindCanRunsToItsEnd) {
  const testing::TemporaryFolder folder;
  const std::string recording = (folder.path() / "run.mcap").string();
  // A runtime folder of its own: the bus is found there by name.
  const testing::Finished run =
      testing::Run({"/usr/bin/env", "XDG_RUNTIME_DIR=" + folder.path().string(),
                    std::string(SINEW_BIN_DIR) + "/sinew", "launch",
                    std::string(SINEW_SOURCE_DIR) + "/robots/rig/deploy_rig_can.yaml", "--set",
                    "domain_id=94", "--set", "duration_s=4", "--record", recording},
                   seconds(100));
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  const std::string text = run.output + run.error;
  EXPECT_NE(text.find("armed"), std::string::npos) << text;
  EXPECT_NE(text.find("959 ticks"), std::string::npos) << text;
  // A starved machine may drop a stale set point; the frames themselves are never wrong.
  EXPECT_NE(text.find(" dropped, 0 error frames"), std::string::npos) << text;
  EXPECT_GT(std::filesystem::file_size(recording), 10'000U);
}

struct BadFile {
  const char* from;
  const char* to;
  const char* expected;
};

class BadInput : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadInput, IsReportedInOneLineWithExitCodeTwo) {
  const testing::TemporaryFolder folder;
  const std::string file =
      folder.Write("can_bridge.yaml",
                   testing::EditedRigConfig("can_bridge.yaml", {{GetParam().from, GetParam().to}}));
  const testing::Finished run =
      testing::Run({std::string(SINEW_BIN_DIR) + "/sinew-can-bridge", "--config", file, "--domain",
                    "93", "--log-level", "off"},
                   seconds(30));
  EXPECT_EQ(run.exit_code, 2) << run.error;
  EXPECT_NE(run.error.find(GetParam().expected), std::string::npos) << run.error;
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
}

INSTANTIATE_TEST_SUITE_P(
    CanBridge, BadInput,
    ::testing::Values(
        BadFile{"gear_ratio: 100", "gear_ratio: .nan", "gear_ratio"},
        BadFile{"velocity_rad_s: 8.0", "velocity_deg_s: 8.0", "velocity_rad_s"},
        BadFile{"direction: 1 ", "direction: 0 ", "direction"},
        BadFile{"firmware: 0.5.6", "firmware: 0.6.1", "0.5.4"},
        BadFile{"origin: sim", "origin: live", "is no hardware"},
        BadFile{"node: 33", "node: 3", "used twice"},
        BadFile{"upper_rad: 1.9", "upper_rad: -2.0", "upper_rad"},
        BadFile{"missed_periods", "missed_period", "missed_period"},
        BadFile{"timing:", "gateways:\n  - {node: 48, joints: [knee]}\ntiming:", "'knee'"},
        BadFile{"timing:", "gateways:\n  - {node: 33, joints: [joint]}\ntiming:", "used twice"},
        BadFile{"transport: virtual",
                "transport: virtual\n    bus: nobody-is-here\n    connect_timeout_ms: 50",
                "sinew-can-bus --bus"},
        BadFile{"transport: virtual", "transport: socketcan\n    interface: can97", "can97"}));

}  // namespace
}  // namespace sinew
