// Assesses what candump saw of can_system_test's run: every frame, byte by byte, by our codec and
// by python3-canmatrix, which knows nothing of it. Runs after the emulated machine has ended; the
// folder SINEW_RESULTS has what it left.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bridge/can/candump.h"
#include "bridge/can/codec.h"
#include "bridge/can/sensor_node.h"
#include "bridge/can/transport/replay_can.h"
#include "bridge/joints/can_plant.h"
#include "bridge/joints/file/bridge_config.h"
#include "tests/kernel/can_system.h"
#include "tests/support/program.h"
#include "tests/support/skip.h"

namespace sinew::can_system {
namespace {

using can::Command;
using can::Frame;
using can::LogLine;
using can::NodeCommand;
using Bytes = decltype(Frame::data);
using Signals = std::map<std::string, double>;

constexpr const char* kPython = "/usr/bin/python3";  // where Debian's packages are

enum class Sender { kBridge, kAxes, kNoise, kNobody };

struct Meaning {
  Sender sender = Sender::kNobody;
  std::string name;  // as the DBC files have it, without the axis
  Signals signals;   // as our codec reads them
};

int NodeOf(const Frame& frame) { return static_cast<int>(frame.id >> can::kCommandBits); }
bool OfSensorNode(const Frame& frame) { return NodeOf(frame) >= SensorNode(0); }

Meaning ReadSensorNode(const Frame& frame) {
  if (const auto m = can::DecodeNodeHeartbeat(frame))
    return {Sender::kAxes, "Node_Heartbeat", {{"Uptime", m->uptime_ms}, {"Node_Error", m->error}}};
  if (const auto m = can::DecodeOutputEncoder(frame)) {
    return {Sender::kAxes,
            "Output_Encoder",
            {{"Angle", m->angle_rad},
             {"Velocity", m->velocity_rad_s},
             {"Sequence", m->sequence},
             {"Watchdog_Expired", m->watchdog_expired}}};
  }
  if (const auto m = can::DecodeJointSensors(frame)) {
    return {Sender::kAxes,
            "Joint_Sensors",
            {{"Chamber_Pressure", m->chamber_pressure_bar},
             {"Load_Force", m->load_force_N},
             {"Motor_Temperature", m->motor_temperature_degC}}};
  }
  if (const auto m = can::DecodeValveCommand(frame)) {
    return {Sender::kBridge,
            "Valve_Command",
            {{"Set_Valve_Open", m->valve_open},
             {"Command_Sequence", m->sequence},
             {"Command_Timeout", m->timeout_ms}}};
  }
  return {};
}

Meaning ReadAxis(const Frame& frame) {
  const Command command = can::AddressOf(frame)->command;
  if (frame.remote) {
    static constexpr std::array kAsked = {Command::kGetEncoderEstimates, Command::kGetIq,
                                          Command::kGetMotorError, Command::kGetEncoderError,
                                          Command::kGetControllerError};
    const bool asked = std::find(kAsked.begin(), kAsked.end(), command) != kAsked.end();
    return asked ? Meaning{Sender::kBridge, "", {}} : Meaning{};
  }
  if (const auto m = can::Decode<can::Heartbeat>(frame)) {
    return {Sender::kAxes,
            "Heartbeat",
            {{"Axis_Error", m->axis_error}, {"Axis_State", static_cast<double>(m->axis_state)}}};
  }
  if (const auto m = can::Decode<can::EncoderEstimates>(frame)) {
    return {Sender::kAxes,
            "Get_Encoder_Estimates",
            {{"Pos_Estimate", m->position_rev}, {"Vel_Estimate", m->velocity_rev_s}}};
  }
  if (const auto m = can::Decode<can::Iq>(frame)) {
    return {
        Sender::kAxes, "Get_Iq", {{"Iq_Setpoint", m->setpoint_A}, {"Iq_Measured", m->measured_A}}};
  }
  if (const auto m = can::Decode<can::MotorError>(frame))
    return {Sender::kAxes, "Get_Motor_Error", {{"Motor_Error", static_cast<double>(m->error)}}};
  if (const auto m = can::Decode<can::EncoderError>(frame))
    return {Sender::kAxes, "Get_Encoder_Error", {{"Encoder_Error", m->error}}};
  if (const auto m = can::Decode<can::ControllerError>(frame))
    return {Sender::kAxes, "Get_Controller_Error", {{"Controller_Error", m->error}}};
  if (const auto m = can::Decode<can::SetAxisState>(frame)) {
    return {Sender::kBridge,
            "Set_Axis_State",
            {{"Axis_Requested_State", static_cast<double>(m->state)}}};
  }
  if (const auto m = can::Decode<can::SetControllerMode>(frame)) {
    return {Sender::kBridge,
            "Set_Controller_Mode",
            {{"Control_Mode", static_cast<double>(m->control_mode)},
             {"Input_Mode", static_cast<double>(m->input_mode)}}};
  }
  if (const auto m = can::Decode<can::SetLimits>(frame)) {
    return {Sender::kBridge,
            "Set_Limits",
            {{"Velocity_Limit", m->velocity_limit_rev_s}, {"Current_Limit", m->current_limit_A}}};
  }
  if (const auto m = can::Decode<can::SetInputTorque>(frame))
    return {Sender::kBridge, "Set_Input_Torque", {{"Input_Torque", m->torque_Nm}}};
  if (can::Decode<can::ClearErrors>(frame)) return {Sender::kBridge, "Clear_Errors", {}};
  return {};
}

std::string Show(const LogLine& line) { return can::FormatCandump(line); }

// The whole run, read once.
struct Recorded {
  std::vector<LogLine> lines;
  std::vector<Meaning> meanings;  // of the lines
  std::multimap<std::string, std::int64_t> marks;
  std::vector<std::pair<std::int64_t, std::int64_t>> quiet;  // nothing may move
  std::vector<can::IdFilter> filters;                        // of the bridge

  std::int64_t mark(const std::string& name) const {
    const auto found = marks.find(name);
    EXPECT_NE(found, marks.end()) << name;
    return found == marks.end() ? 0 : found->second;
  }
  bool is_quiet(std::int64_t stamp_ns) const {
    return std::any_of(quiet.begin(), quiet.end(), [stamp_ns](const auto& span) {
      return stamp_ns >= span.first && stamp_ns < span.second;
    });
  }
};

Recorded Read(const std::string& folder) {
  Recorded run;
  std::ifstream marks(folder + kMarksFile);
  std::string name;
  std::int64_t value = 0, from = 0;
  while (marks >> name >> value) {
    run.marks.emplace(name, value);
    if (name == "quiet") from = value;
    if (name == "armed") run.quiet.emplace_back(from, value);
  }
  run.quiet.emplace_back(from, std::numeric_limits<std::int64_t>::max());
  run.lines = can::ReadCandumpFile(folder + kLogFile);
  const bridge::BridgeFile file = config::Read<bridge::BridgeFile>(
      config::Section::Load(folder + "bridge.yaml", "sinew-can-bridge/1"));
  run.filters = bridge::ReceiveFilters(file.bridge, 0);
  const std::int64_t noise_from = run.mark("noise_from"), noise_until = run.mark("noise_until");
  for (const LogLine& line : run.lines) {
    const Frame& frame = line.frame;
    Meaning meaning;
    if (!frame.extended && !frame.error && IsOurs(frame.id))
      meaning = OfSensorNode(frame) ? ReadSensorNode(frame) : ReadAxis(frame);
    if (meaning.sender == Sender::kNobody && line.stamp_ns >= noise_from &&
        line.stamp_ns <= noise_until) {
      meaning.sender = Sender::kNoise;
    }
    run.meanings.push_back(std::move(meaning));
  }
  return run;
}

class CanSystemLog : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("SINEW_RESULTS");
    const std::string path = std::string(folder == nullptr ? "." : folder) + "/";
    std::string skipped;  // why run_on_kernel.sh made no run
    if (std::getline(std::ifstream(path + "skipped"), skipped)) GTEST_SKIP() << skipped;
    ASSERT_TRUE(std::filesystem::exists(path + kLogFile)) << "no run to assess";
    run_ = Read(path);
    ASSERT_FALSE(run_.lines.empty());
  }
  Recorded run_;
};

TEST_F(CanSystemLog, HasOnlyFramesOfTheTwoSidesAndExactlyTheNoiseThatWasMade) {
  std::int64_t extended = 0, foreign = 0, broken = 0;
  std::set<std::uint32_t> seen;
  for (std::size_t i = 0; i < run_.lines.size(); ++i) {
    const Frame& frame = run_.lines[i].frame;
    const Sender sender = run_.meanings[i].sender;
    ASSERT_NE(sender, Sender::kNobody) << Show(run_.lines[i]);
    if (sender != Sender::kNoise) seen.insert(frame.id);
    if (sender == Sender::kNoise)
      ++(frame.extended ? extended : IsOurs(frame.id) ? broken : foreign);
  }
  EXPECT_EQ(extended, run_.mark("noise_cangen"));
  EXPECT_EQ(foreign, run_.mark("noise_foreign"));
  EXPECT_EQ(broken, run_.mark("noise_broken"));
  // Every node sent its messages.
  for (int j = 0; j < kJoints; ++j) {
    for (const Command command : {Command::kHeartbeat, Command::kGetEncoderEstimates,
                                  Command::kGetIq, Command::kSetInputTorque}) {
      EXPECT_EQ(seen.count(can::Identifier(AxisNode(j), command)), 1U) << j;
    }
  }
  for (int j = 0; j < kSensorNodes; ++j) {
    for (const NodeCommand command : {NodeCommand::kHeartbeat, NodeCommand::kOutputEncoder,
                                      NodeCommand::kJointSensors, NodeCommand::kValveCommand}) {
      EXPECT_EQ(seen.count(can::Identifier(SensorNode(j), command)), 1U) << j;
    }
  }
}

TEST_F(CanSystemLog, HasAsManyFramesAsTheBridgeSaysItSentAndReceived) {
  std::int64_t sent = 0, received = 0;
  for (std::size_t i = 0; i < run_.lines.size(); ++i) {
    if (run_.meanings[i].sender == Sender::kBridge) {
      ++sent;
    } else if (can::Passes(run_.filters, run_.lines[i].frame)) {
      ++received;
    }
  }
  EXPECT_EQ(sent, run_.mark("bridge_sent"));
  EXPECT_EQ(received, run_.mark("bridge_received"));
}

TEST_F(CanSystemLog, HasTheSetpointsOfEachJointsCommandsByteForByte) {
  std::map<std::pair<std::uint32_t, Bytes>, int> numbers;
  for (int j = 0; j < kJoints; ++j) {
    for (int k = 0; k < kCommands; ++k) {
      const Frame frame = Setpoint(j, k);
      ASSERT_TRUE(numbers.emplace(std::pair{frame.id, frame.data}, k).second);
    }
  }
  constexpr int kNone = -1;
  std::array<int, kJoints> number;  // of this cycle's commands
  number.fill(kNone);
  int next_joint = 0, last = kNone;
  std::int64_t frames = 0, cycles = 0, in_turn = 0;
  for (std::size_t i = 0; i < run_.lines.size(); ++i) {
    const LogLine& line = run_.lines[i];
    if (run_.meanings[i].name != "Set_Input_Torque") continue;
    const int joint = NodeOf(line.frame) - AxisNode(0);
    const bool zero = run_.meanings[i].signals.at("Input_Torque") == 0.0;
    ASSERT_EQ(line.frame.length, 4) << Show(line);
    if (run_.is_quiet(line.stamp_ns)) {
      ASSERT_TRUE(zero) << "nothing may move: " << Show(line);
      next_joint = 0;
      last = kNone;
      continue;
    }
    const auto found = numbers.find({line.frame.id, line.frame.data});
    ASSERT_TRUE(zero || found != numbers.end()) << "was not commanded: " << Show(line);
    if (joint == 0) next_joint = 0;
    ASSERT_EQ(joint, next_joint++) << "the joints have their turns: " << Show(line);
    number[static_cast<std::size_t>(joint)] = zero ? kNone : found->second;
    frames += zero ? 0 : 1;
    if (joint + 1 < kJoints) continue;
    // All joints of a cycle follow one command message. Zero: not yet in closed loop.
    int commanded = kNone;
    for (const int k : number) {
      if (k == kNone) continue;
      ASSERT_TRUE(commanded == kNone || k == commanded) << Show(line);
      commanded = k;
    }
    if (std::find(number.begin(), number.end(), kNone) != number.end()) continue;
    ++cycles;
    in_turn += last == kNone || commanded == (last + 1) % kCommands ? 1 : 0;
    last = commanded;
  }
  std::printf("%lld setpoints compared, %lld cycles of twelve joints, %lld with the next command\n",
              static_cast<long long>(frames), static_cast<long long>(cycles),
              static_cast<long long>(in_turn));
  EXPECT_GE(cycles, run_.mark("armed_cycles"));
  // A starved controller may miss a cycle; the bridge then holds the command before.
  EXPECT_GE(in_turn, cycles * 9 / 10);
}

TEST_F(CanSystemLog, LetsNoAxisIntoClosedLoopBeforeItIsArmed) {
  std::array<double, kJoints> state{}, error{};
  auto span = run_.quiet.begin();
  int armings = 0;
  for (std::size_t i = 0; i < run_.lines.size(); ++i) {
    const LogLine& line = run_.lines[i];
    const Meaning& meaning = run_.meanings[i];
    for (; span != run_.quiet.end() && line.stamp_ns >= span->second; ++span, ++armings) {
      for (int j = 0; j < kJoints; ++j) {
        EXPECT_EQ(state[static_cast<std::size_t>(j)], 1.0) << "axis " << j << " is idle";
        EXPECT_EQ(error[static_cast<std::size_t>(j)], 0.0) << "axis " << j;
      }
    }
    if (meaning.name == "Heartbeat") {
      const auto joint = static_cast<std::size_t>(NodeOf(line.frame) - AxisNode(0));
      state[joint] = meaning.signals.at("Axis_State");
      error[joint] = meaning.signals.at("Axis_Error");
    }
    if (!run_.is_quiet(line.stamp_ns)) continue;
    EXPECT_NE(meaning.name, "Set_Controller_Mode") << Show(line);
    if (meaning.name == "Set_Axis_State") {
      EXPECT_EQ(meaning.signals.at("Axis_Requested_State"), 1.0) << Show(line);
    }
  }
  EXPECT_EQ(armings, 3) << "at first, after the interface was down, after bus-off";
}

TEST_F(CanSystemLog, ShowsThatEachAxisTookItsOwnSetpoint) {
  std::array<std::int64_t, kJoints> active{};
  for (std::size_t i = 0; i < run_.lines.size(); ++i) {
    if (run_.meanings[i].name != "Get_Iq") continue;
    const double current_A = run_.meanings[i].signals.at("Iq_Setpoint");
    if (current_A == 0.0) continue;
    const int joint = NodeOf(run_.lines[i].frame) - AxisNode(0);
    const double torque_Nm = Direction(joint) * current_A * kTorqueConstant_Nm_A;
    const double number = (torque_Nm - MotorTorque_Nm(joint, 0)) / 1e-5;
    // A float's worth of a command's step.
    ASSERT_NEAR(number, std::round(number), 0.01) << Show(run_.lines[i]);
    ASSERT_TRUE(number > -0.5 && number < kCommands - 0.5) << Show(run_.lines[i]);
    ++active[static_cast<std::size_t>(joint)];
  }
  for (int j = 0; j < kJoints; ++j) EXPECT_GT(active[static_cast<std::size_t>(j)], 100) << j;
}

TEST_F(CanSystemLog, MeansTheSameToAnIndependentReader) {
  SKIP_WITHOUT_PACKAGE(testing::Run({kPython, "-c", "import canmatrix.formats"}).exit_code == 0,
                       "python3-canmatrix");
  constexpr std::size_t kMost =
      80;  // different frames of each identifier: all setpoints of a joint
  std::map<std::uint32_t, std::set<Bytes>> seen;
  struct Batch {
    std::string dbc;
    std::vector<std::string> frames;
    std::vector<const Meaning*> meanings;
    std::vector<std::string> names;
  };
  std::array<Batch, 2> batches;
  batches[0].dbc = std::string(SINEW_SOURCE_DIR) + "/bridge/can/sinew_nodes.dbc";
  batches[1].dbc =
      std::string(SINEW_SHARED_DIR) + "/data/odrive_cansimple_dbc/odrive-cansimple.dbc";
  for (std::size_t i = 0; i < run_.lines.size(); ++i) {
    const Frame& frame = run_.lines[i].frame;
    const Meaning& meaning = run_.meanings[i];
    if (meaning.signals.empty()) continue;
    auto& different = seen[frame.id];
    if (different.size() >= kMost || !different.insert(frame.data).second) continue;
    // The files describe one sensor node, 32, and eight axes; the others are their like. Bytes that
    // short frames leave out are zero.
    const bool axis = !OfSensorNode(frame);
    const int node = axis ? NodeOf(frame) % 8 : 32;
    char text[40];
    int at = std::snprintf(text, sizeof text, "%03X#",
                           static_cast<unsigned>(node << can::kCommandBits) |
                               (frame.id & ((1U << can::kCommandBits) - 1)));
    const int length = axis ? can::kMaxDataBytes : frame.length;
    for (int k = 0; k < length; ++k) {
      at += std::snprintf(text + at, sizeof text - static_cast<std::size_t>(at), "%02X",
                          frame.data[static_cast<std::size_t>(k)]);
    }
    Batch& batch = batches[axis ? 1 : 0];
    batch.frames.emplace_back(text);
    batch.meanings.push_back(&meaning);
    batch.names.push_back(axis ? "Axis" + std::to_string(node) + "_" + meaning.name : meaning.name);
  }
  for (const Batch& batch : batches) {
    if (!std::filesystem::exists(batch.dbc)) {
      std::printf("no %s: its frames are not compared\n", batch.dbc.c_str());
      continue;
    }
    std::vector<std::string> arguments = {
        kPython, std::string(SINEW_SOURCE_DIR) + "/tests/bridge/can/decode_frames.py", batch.dbc};
    arguments.insert(arguments.end(), batch.frames.begin(), batch.frames.end());
    const testing::Finished reader = testing::Run(arguments, std::chrono::seconds(60));
    ASSERT_EQ(reader.exit_code, 0) << reader.error;
    std::istringstream lines(reader.output);
    std::size_t i = 0;
    for (std::string line; std::getline(lines, line); ++i) {
      ASSERT_LT(i, batch.frames.size());
      std::istringstream words(line);
      std::string name, word;
      words >> name;
      ASSERT_EQ(name, batch.names[i]) << batch.frames[i];
      Signals signals;
      while (words >> word) {
        const std::size_t equals = word.find('=');
        signals[word.substr(0, equals)] = std::stod(word.substr(equals + 1));
      }
      for (const auto& [signal, value] : batch.meanings[i]->signals) {
        ASSERT_EQ(signals.count(signal), 1U) << name << '.' << signal;
        // The same bytes, read twice: they differ by rounding only.
        ASSERT_NEAR(signals.at(signal), value, 1e-9 * std::max(1.0, std::abs(value)))
            << name << '.' << signal << ' ' << batch.frames[i];
      }
    }
    ASSERT_EQ(i, batch.frames.size());
    std::printf("%zu different frames compared with %s\n", batch.frames.size(),
                std::filesystem::path(batch.dbc).filename().c_str());
  }
}

}  // namespace
}  // namespace sinew::can_system
