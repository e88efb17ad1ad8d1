// The robot behind CAN on a real kernel: sinew-can-bridge and sinew-virtual-axes as two processes
// on a vcan interface with twelve joints; candump is the witness, this program plays control,
// operator, noise and failing hardware. run_on_kernel.sh starts it. The tests are one story: each
// goes on where the one before it ended. What candump saw is assessed afterwards, by
// can_system_log_test.
#include "tests/kernel/can_system.h"

#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <signal.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "components/base/types/clock/clock.h"
#include "components/topics/node/node.h"
#include "tests/kernel/raw_socket.h"
#include "tests/support/motors_alone.h"
#include "tests/support/program.h"

namespace sinew::can_system {
namespace {

using can::Interface;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Program;

constexpr int kCycles = 2400;       // armed, nothing else happening
constexpr int kQuietCycles = 60;    // how long it is watched that nothing moves
constexpr double kRest_rad = 0.03;  // at the motor's shaft: noise of its encoder
constexpr double kMoves_rad = 5.0;
constexpr double kDryFriction_Nm = 5e-5;  // the surrogate's motor

std::string Folder(const char* variable) {
  const char* folder = std::getenv(variable);
  if (folder == nullptr) throw std::runtime_error(std::string(variable) + " is not set");
  return std::string(folder) + "/";
}

std::string ReadText(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

bool WaitUntil(seconds limit, const std::function<bool()>& done) {
  const auto give_up = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

std::string BusText() {
  return "buses:\n  - name: bus\n    transport: socketcan\n    interface: " + Interface() + "\n";
}

std::string Serial(int joint) { return "A" + std::to_string(joint); }

std::string BridgeText() {
  std::ostringstream text;
  text << "schema: sinew-can-bridge/1\norigin: live\n" << BusText() << "joints:\n";
  for (int j = 0; j < kJoints; ++j) {
    text << "  - {name: joint" << j << ", node: " << AxisNode(j) << ", serial_number: " << Serial(j)
         << ", direction: " << Direction(j) << ", gear_ratio: " << kGearRatio
         << ", zero_rev: " << ZeroRev(j) << ", torque_constant_Nm_A: " << kTorqueConstant_Nm_A
         << ", controller_torque_constant_Nm_A: " << kControllerTorqueConstant_Nm_A
         << ", limits: {motor_torque_Nm: 0.398, current_A: 25, velocity_rad_s: 25"
         << ", lower_rad: -1000, upper_rad: 1000}";
    if (j < kSensorNodes) {
      text << ", sensor_node: {node: " << SensorNode(j) << ", direction: " << Direction(j)
           << ", zero_rad: " << OutputZero_rad(j) << "}";
    }
    text << "}\n";
  }
  // The axes' own watchdog is quicker than the bridge's patience, both far from a starved moment.
  text << "timing: {iq_every_cycles: 4, estimate_timeout_ms: 300, lost_after_ms: 700, "
          "heartbeat_timeout_ms: 2000, "
          "start_timeout_ms: 60000, closed_loop_timeout_ms: 5000, valve_timeout_ms: 500}\n"
          "guard: {missed_periods: 100, fault_after_ms: 10000}\n"
          "estop: {socket: none, latch: estop.latch}\n"
          "watchdog_proof: proof.yaml\n";
  return text.str();
}

// Live hardware is armed with proofs only. These are written by hand: an emulated machine does not
// keep the times that a proof asks for.
std::string ProofText() {
  std::ostringstream text;
  text << "schema: sinew-watchdog-proof/1\nproofs:\n";
  for (int j = 0; j < kJoints; ++j) {
    text << "  - {joint: joint" << j << ", serial_number: " << Serial(j)
         << ", node: " << AxisNode(j) << ", idle_after_ms: 100, made: test}\n";
  }
  return text.str();
}

std::string AxesText() {
  std::ostringstream text;
  text << "schema: sinew-virtual-axes/1\n"
       << BusText() << "surrogate: surrogate.yaml\nstep_ms: 2\naxes:\n";
  for (int j = 0; j < kJoints; ++j) {
    text << "  - {node: " << AxisNode(j) << ", joint: " << j << ", direction: " << Direction(j)
         << ", zero_rev: " << ZeroRev(j) << ", gear_ratio: " << kGearRatio
         << ", torque_constant_Nm_A: " << kTorqueConstant_Nm_A
         << ", controller_torque_constant_Nm_A: " << kControllerTorqueConstant_Nm_A
         << ", velocity_limit_rev_s: 500, watchdog_ms: 500, heartbeat_ms: 100, encoder_ms: 20}\n";
  }
  text << "sensor_nodes:\n";
  for (int j = 0; j < kSensorNodes; ++j) {
    text << "  - {node: " << SensorNode(j) << ", joint: " << j << ", direction: " << Direction(j)
         << ", zero_rad: " << OutputZero_rad(j) << ", encoder_ms: 20, sensors_ms: 50}\n";
  }
  return text.str();
}

using Angles = std::array<double, kJoints>;  // of the motors' shafts

// How far the joints have moved from there: that which moved least, and most.
std::pair<double, double> Moved(const Angles& from_rad, const Angles& to_rad) {
  double least_rad = std::numeric_limits<double>::infinity(), most_rad = 0.0;
  for (std::size_t j = 0; j < kJoints; ++j) {
    const double moved_rad = std::abs(to_rad[j] - from_rad[j]);
    least_rad = std::min(least_rad, moved_rad);
    most_rad = std::max(most_rad, moved_rad);
  }
  return {least_rad, most_rad};
}

class System {
 public:
  System() {
    std::ofstream(results_ + "surrogate.yaml") << testing::kMotorsAlone;
    std::ofstream(results_ + "bridge.yaml") << BridgeText();
    std::ofstream(results_ + "axes.yaml") << AxesText();
    std::ofstream(results_ + "proof.yaml") << ProofText();
    // Sockets that keep the frames of seconds: every frame is counted, also while a reader is held.
    std::ofstream("/proc/sys/net/core/rmem_default") << 16777216;
    candump_ =
        Start({"/bin/sh", "-c",
               "exec candump -D -r 16777216 -L " + Interface() + " > " + results_ + kLogFile});
    EXPECT_TRUE(WaitUntil(seconds(20), [&] {
      return ReadText("/proc/net/can/rcvlist_all").find(Interface() + " ") != std::string::npos;
    })) << "candump does not listen";
    // The bridge listens before the first axis sends: it has to count all of their frames.
    bridge_ = Start({programs_ + "sinew-can-bridge", "--config", results_ + "bridge.yaml", "--rate",
                     "200", "--domain", std::to_string(kDomain)});
    EXPECT_TRUE(bridge_->WaitForText("12 joints on 1 buses", seconds(30))) << bridge_->error();
    axes_ = Start({programs_ + "sinew-virtual-axes", "--config", results_ + "axes.yaml"});
  }
  ~System() { std::ofstream("/proc/sys/net/core/rmem_default") << before_; }

  Program& bridge() { return *bridge_; }
  Program& axes() { return *axes_; }
  Program& candump() { return *candump_; }
  const msg::JointState& state() const { return state_; }
  const msg::ActuatorState& actuator() const { return actuator_; }
  const msg::BusStatus& bus() const { return bus_; }
  const msg::ComponentStatus& status() const { return status_; }
  std::uint64_t cycles() const { return cycles_; }
  const Angles& motor_rad() const { return actuator_.motor_position_rad; }
  bool all_valid() const {
    return std::all_of(state_.valid.begin(), state_.valid.begin() + kJoints,
                       [](bool valid) { return valid; });
  }

  // Answers every state with each joint's torque, whoever may move or not, until `done`.
  bool Run(seconds limit, const std::function<bool()>& done) {
    const auto give_up = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < give_up) {
      const auto state = states_.WaitNext(milliseconds(200));
      if (!state) continue;
      state_ = *state;
      ++cycles_;
      msg::JointCommand command;
      command.header = state_.header;
      command.joint_count = kJoints;
      const int number = static_cast<int>(state_.header.tick % kCommands);
      for (int j = 0; j < kJoints; ++j) {
        const auto i = static_cast<std::size_t>(j);
        command.mode[i] = msg::CommandMode::kTorque;
        command.motor_torque_Nm[i] = MotorTorque_Nm(j, number);
      }
      (void)commands_.Write(command);
      while (const auto actuator = actuators_.TakeNext()) actuator_ = *actuator;
      while (const auto bus = bus_status_.TakeNext()) bus_ = *bus;
      while (const auto status = component_.TakeNext()) {
        if (status->name == "can-bridge") status_ = *status;
      }
      if (done()) return true;
    }
    return false;
  }
  bool RunCycles(int count) {
    const std::uint64_t until = state_.header.tick + static_cast<std::uint64_t>(count);
    return Run(seconds(60), [&] { return state_.header.tick >= until; });
  }
  bool RunUntil(msg::RobotState wanted) {
    return Run(seconds(30), [&] { return state_.robot_state == wanted; });
  }
  // The motor runs out.
  bool RunUntilAtRest() {
    Angles before_rad = motor_rad();
    std::uint64_t since = state_.header.tick;
    return Run(seconds(30), [&] {
      if (Moved(before_rad, motor_rad()).second > 0.5 * kRest_rad) {
        before_rad = motor_rad();
        since = state_.header.tick;
      }
      return state_.header.tick > since + 25;
    });
  }
  void Operator(msg::OperatorAction action) {
    msg::OperatorCommand command;
    command.header = state_.header;
    command.action = action;
    (void)operator_.Write(command);
  }
  bool Ask(msg::OperatorAction action, msg::RobotState wanted) {
    return Run(seconds(30), [&, k = 0]() mutable {
      if (state_.robot_state == wanted) return true;
      if (k++ % 50 == 0) Operator(action);
      return false;
    });
  }
  // From here on nothing may move, from there on it may: written down for the check of the log.
  void Quiet() { Mark("quiet", std::to_string(state_.header.stamp_ns)); }
  bool Arm() {
    Mark("armed", std::to_string(types::EpochNow_ns()));
    return Ask(msg::OperatorAction::kArm, msg::RobotState::kArmed);
  }
  void Mark(const std::string& name, const std::string& value) {
    marks_ << name << ' ' << value << '\n' << std::flush;
  }

 private:
  static constexpr int kDomain = 96;
  static node::Options NodeOptions() {
    node::Options options;
    options.component = options.name = "test";
    options.domain_id = kDomain;
    return options;
  }
  static std::unique_ptr<Program> Start(const std::vector<std::string>& arguments) {
    return std::make_unique<Program>(arguments);
  }

  const std::string results_ = Folder("SINEW_RESULTS"), programs_ = Folder("SINEW_PROGRAMS");
  const std::string before_ = ReadText("/proc/sys/net/core/rmem_default");
  std::ofstream marks_{results_ + kMarksFile};
  node::Node node_{NodeOptions()};
  node::Reader<msg::JointState> states_ = node_.MakeReader(node::kJointState);
  node::Reader<msg::ActuatorState> actuators_ = node_.MakeReader(node::kActuatorState);
  node::Reader<msg::BusStatus> bus_status_ = node_.MakeReader(node::kBusStatus);
  node::Reader<msg::ComponentStatus> component_ = node_.MakeReader(node::kComponentStatus);
  node::Writer<msg::JointCommand> commands_ = node_.MakeWriter(node::kJointCommand);
  node::Writer<msg::OperatorCommand> operator_ = node_.MakeWriter(node::kOperatorCommand);
  std::unique_ptr<Program> candump_, bridge_, axes_;
  msg::JointState state_;
  msg::ActuatorState actuator_;
  msg::BusStatus bus_;
  msg::ComponentStatus status_;
  std::uint64_t cycles_ = 0;
};

class CanSystem : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { system_ = std::make_unique<System>(); }
  static void TearDownTestSuite() { system_.reset(); }
  static System& it() { return *system_; }

  // What follows every failure of the bus: it works again, yet nothing moves until an operator has
  // reset and armed.
  static void ExpectRestUntilResetAndArmed() {
    ASSERT_TRUE(it().Run(seconds(30), [] { return it().all_valid() && it().bus().up[0]; }))
        << it().bridge().error();
    ASSERT_TRUE(it().RunUntilAtRest());
    const Angles rest_rad = it().motor_rad();
    ASSERT_TRUE(it().RunCycles(kQuietCycles));
    EXPECT_EQ(it().state().robot_state, msg::RobotState::kFault);
    EXPECT_LT(Moved(rest_rad, it().motor_rad()).second, kRest_rad);
    ASSERT_TRUE(it().Ask(msg::OperatorAction::kReset, msg::RobotState::kDisarmed))
        << it().bridge().error();
    ASSERT_TRUE(it().RunCycles(kQuietCycles));
    EXPECT_EQ(it().state().robot_state, msg::RobotState::kDisarmed) << it().bridge().error();
    EXPECT_LT(Moved(rest_rad, it().motor_rad()).second, kRest_rad);
    ASSERT_TRUE(it().Arm()) << it().bridge().error();
    EXPECT_TRUE(it().Run(seconds(30), [&] {
      return Moved(rest_rad, it().motor_rad()).first > kMoves_rad;
    })) << it().bridge().error();
    EXPECT_EQ(it().state().robot_state, msg::RobotState::kArmed) << it().bridge().error();
  }
  // Armed and whole, before something is done to it.
  static void ExpectArmed() {
    ASSERT_TRUE(it().RunCycles(10));
    ASSERT_EQ(it().state().robot_state, msg::RobotState::kArmed) << it().bridge().error();
    ASSERT_TRUE(it().all_valid());
  }

 private:
  static inline std::unique_ptr<System> system_;
};

TEST_F(CanSystem, TwelveJointsRestWhileDisarmedAndFollowTheirCommandsForThousandsOfCycles) {
  ASSERT_TRUE(it().Run(seconds(60), [] { return it().all_valid(); }))
      << it().bridge().error() << it().axes().error();
  it().Quiet();
  EXPECT_EQ(it().state().joint_count, kJoints);
  EXPECT_EQ(it().state().header.origin, msg::Origin::kLive);
  EXPECT_EQ(it().state().robot_state, msg::RobotState::kDisarmed);
  ASSERT_TRUE(it().RunUntilAtRest());
  const Angles rest_rad = it().motor_rad();
  ASSERT_TRUE(it().RunCycles(kQuietCycles));
  EXPECT_LT(Moved(rest_rad, it().motor_rad()).second, kRest_rad);

  ASSERT_TRUE(it().Arm()) << it().bridge().error();
  ASSERT_TRUE(it().RunCycles(50)) << "until all are in closed loop and their speeds stand";
  const Angles start_rad = it().motor_rad();
  const std::uint64_t first = it().cycles(), until = it().state().header.tick + kCycles;
  int armed = 0;
  ASSERT_TRUE(it().Run(seconds(120), [&] {
    armed += it().state().robot_state == msg::RobotState::kArmed ? 1 : 0;
    return it().state().header.tick >= until;
  }));
  const auto seen = static_cast<int>(it().cycles() - first);
  EXPECT_EQ(armed, seen) << it().bridge().error();
  EXPECT_GE(seen, kCycles * 9 / 10) << "states that came here";
  // Drag alone holds the motors: each has gone as far as its own torque, less its dry friction.
  const double mean_number = 0.5 * (kCommands - 1);
  const auto reach_rad = [&](int j) {
    const auto i = static_cast<std::size_t>(j);
    return (it().motor_rad()[i] - start_rad[i]) /
           (MotorTorque_Nm(j, 0) + mean_number * (MotorTorque_Nm(j, 1) - MotorTorque_Nm(j, 0)) -
            kDryFriction_Nm);
  };
  constexpr double kTolerance =
      0.05;  // a joint is off by 8 % at least when it has another's torque
  for (int j = 1; j < kJoints; ++j) EXPECT_NEAR(reach_rad(j) / reach_rad(0), 1.0, kTolerance) << j;
  EXPECT_EQ(it().bus().frames_dropped[0], 0U);
  EXPECT_EQ(it().bus().error_frames[0], 0U);
  std::printf(
      "%d cycles armed, %d states seen; load %.0f %% of 1 Mbit/s, bridge's work p50 %.0f us\n",
      kCycles, seen, it().bus().load_percent[0], it().bus().cycle_p50_us);
}

TEST_F(CanSystem, NoiseOfOthersAndBrokenFramesOfOurOwnMoveNothing) {
  ExpectArmed();
  constexpr int kCangen = 1500, kForeign = 2000, kBroken = 800;
  it().Mark("noise_from", std::to_string(types::EpochNow_ns()));
  Program cangen({"cangen", Interface(), "-e", "-g", "1", "-n", std::to_string(kCangen)});
  const can::RawSocket socket;
  std::mt19937 random(1);
  int foreign = 0, broken = 0;
  bool ended = false;
  const auto send = [&](std::uint32_t id, int length) {
    can_frame frame{};
    frame.can_id = id;
    frame.can_dlc = static_cast<__u8>(length);
    for (int i = 0; i < length; ++i) frame.data[i] = static_cast<__u8>(random());
    return socket.Send(frame) ? 1 : 0;
  };
  // Too short for what it says it is, yet not empty: an empty frame can be a request.
  struct Short {
    std::uint32_t command;
    int longest;
  };
  static constexpr Short kOfAxis[] = {{0x01, 3}, {0x07, 3}, {0x09, 7}, {0x0B, 7}, {0x0C, 7},
                                      {0x0D, 7}, {0x0E, 3}, {0x0F, 7}, {0x14, 7}};
  static constexpr Short kOfNode[] = {{0x09, 7}, {0x0A, 7}, {0x0B, 3}};
  EXPECT_TRUE(it().Run(
      seconds(60),
      [&] {
        for (int i = 0; i < 20 && foreign < kForeign; ++i) {
          std::uint32_t id = random() & 0x7FF;
          while (IsOurs(id)) id = random() & 0x7FF;
          foreign += send(id, static_cast<int>(random() % 9));
        }
        for (int i = 0; i < 8 && broken < kBroken; ++i) {
          const bool axis = random() % 2 == 0;
          const auto joint = static_cast<int>(random() % (axis ? kJoints : kSensorNodes));
          const Short& kind = axis ? kOfAxis[random() % std::size(kOfAxis)]
                                   : kOfNode[random() % std::size(kOfNode)];
          const int node = axis ? AxisNode(joint) : SensorNode(joint);
          broken += send(static_cast<std::uint32_t>(node) << can::kCommandBits | kind.command,
                         1 + static_cast<int>(random() % static_cast<unsigned>(kind.longest)));
        }
        EXPECT_EQ(it().state().robot_state, msg::RobotState::kArmed);
        EXPECT_TRUE(it().all_valid());
        ended = ended || cangen.Wait(milliseconds(0)) == 0;
        return ended && foreign == kForeign && broken == kBroken;
      }))
      << it().bridge().error() << cangen.error();
  it().Mark("noise_until", std::to_string(types::EpochNow_ns()));
  it().Mark("noise_cangen", std::to_string(kCangen));
  it().Mark("noise_foreign", std::to_string(foreign));
  it().Mark("noise_broken", std::to_string(broken));
  ExpectArmed();
  EXPECT_EQ(it().bus().error_frames[0], 0U);
}

TEST_F(CanSystem, InterfaceThatIsDownForASecondIsAFaultThatOnlyAnOperatorEnds) {
  ExpectArmed();
  ASSERT_EQ(testing::Run({"ip", "link", "set", Interface(), "down"}).exit_code, 0);
  ASSERT_TRUE(it().RunUntil(msg::RobotState::kFault)) << it().bridge().error();
  it().Quiet();
  EXPECT_TRUE(it().bridge().WaitForText("bus '" + Interface() + "' is down", seconds(5)))
      << it().bridge().error();
  EXPECT_TRUE(it().Run(seconds(5), [] { return !it().bus().up[0] && !it().all_valid(); }));
  EXPECT_TRUE(it().Run(seconds(5), [] {
    return it().status().state == msg::ComponentState::kFault;
  })) << "component_status";
  ASSERT_TRUE(it().RunCycles(100)) << "the rest of the second, and more";
  EXPECT_EQ(it().state().robot_state, msg::RobotState::kFault);
  EXPECT_GT(it().bus().frames_dropped[0], 0U);
  ASSERT_EQ(testing::Run({"ip", "link", "set", Interface(), "up"}).exit_code, 0);
  ExpectRestUntilResetAndArmed();
}

// vcan has no controller that could go bus-off: its report is injected, and the bus is silent
// because the axes are held.
TEST_F(CanSystem, BusOffIsAFaultThatOnlyAnOperatorEndsAfterTheRestart) {
  ExpectArmed();
  const can::RawSocket socket;
  const std::string stat = "/proc/" + std::to_string(it().axes().pid()) + "/stat";
  it().axes().Signal(SIGSTOP);
  ASSERT_TRUE(
      WaitUntil(seconds(5), [&] { return ReadText(stat).find(") T ") != std::string::npos; }));
  ASSERT_TRUE(socket.SendError(CAN_ERR_BUSOFF));
  EXPECT_TRUE(it().Run(seconds(5), [] { return !it().bus().up[0]; }));
  EXPECT_EQ(it().bus().error_frames[0], 1U);
  ASSERT_TRUE(it().RunUntil(msg::RobotState::kFault)) << it().bridge().error();
  it().Quiet();
  EXPECT_TRUE(it().bridge().WaitForText("bus '" + Interface() + "' is bus-off", seconds(5)))
      << it().bridge().error();
  ASSERT_TRUE(it().RunCycles(kQuietCycles));
  EXPECT_FALSE(it().bus().up[0]);
  ASSERT_TRUE(socket.SendError(CAN_ERR_RESTARTED));
  EXPECT_TRUE(it().Run(seconds(5), [] { return it().bus().up[0]; }));
  EXPECT_EQ(it().bus().error_frames[0], 2U);
  it().axes().Signal(SIGCONT);
  ExpectRestUntilResetAndArmed();
}

TEST_F(CanSystem, EndsWithTheCountsThatTheLogMustShow) {
  ExpectArmed();
  ASSERT_TRUE(it().Ask(msg::OperatorAction::kDisarm, msg::RobotState::kDisarmed))
      << it().bridge().error();
  it().Quiet();
  // First the axes, then the bridge: it has read everything when it ends.
  it().axes().Signal(SIGTERM);
  EXPECT_EQ(it().axes().Wait(seconds(20)), 0) << it().axes().error();
  ASSERT_TRUE(it().RunCycles(10));
  const msg::BusStatus last = it().bus();
  it().bridge().Signal(SIGTERM);
  EXPECT_EQ(it().bridge().Wait(seconds(20)), 0) << it().bridge().error();
  it().candump().Signal(SIGTERM);
  (void)it().candump().Wait(seconds(20));
  EXPECT_EQ(it().candump().error().find("dropped"), std::string::npos) << it().candump().error();

  const std::string said = it().bridge().error();
  unsigned long long sent = 0, received = 0, dropped = 0, errors = 0;
  const std::size_t at = said.find("bus '" + Interface() + "': ");
  ASSERT_NE(at, std::string::npos) << said;
  ASSERT_EQ(std::sscanf(said.c_str() + said.find(": ", at),
                        ": %llu frames sent, %llu received, %llu dropped, %llu error frames", &sent,
                        &received, &dropped, &errors),
            4)
      << said;
  EXPECT_EQ(errors, 2U);
  // bus_status reported the same, except for the frames of the last cycles.
  EXPECT_LE(last.frames_sent[0], sent);
  EXPECT_GE(last.frames_sent[0] + 20 * 3 * kJoints, sent);
  EXPECT_LE(last.frames_received[0], received);
  EXPECT_GE(last.frames_received[0] + 200, received);
  EXPECT_LE(last.frames_dropped[0], dropped);
  it().Mark("bridge_sent", std::to_string(sent));
  it().Mark("bridge_received", std::to_string(received));
  it().Mark("armed_cycles", std::to_string(kCycles));
  std::printf("%llu cycles in all; the bridge sent %llu frames and received %llu\n",
              static_cast<unsigned long long>(it().state().header.tick), sent, received);
}

}  // namespace
}  // namespace sinew::can_system
