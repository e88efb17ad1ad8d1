#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bridge/can/compact.h"
#include "components/base/types/control_mode.h"
#include "tests/fuzz/harness.h"
#include "tests/fuzz/property.h"
#include "tests/fuzz/watched_plant.h"

namespace sinew::fuzz {
namespace {

using types::ControlMode;

constexpr int kJoints = 4;
constexpr int kMostCycles = 400;

// What the bytes choose. kAimed is a frame of a chosen length from a node of ours, in its kinds.
enum class Op : std::uint8_t {
  kAnyFrame,
  kAimed,
  kCommand,
  kCycle,
  kCycleInSilence,
  kArmAll,
  kFlood,
  kClearFault,
};
constexpr std::uint8_t kOps = 8;
constexpr std::array<std::uint32_t, 8> kAimedKinds = {0x01, 0x03, 0x04, 0x09,
                                                      0x14, 0x1D, 0x0A, 0x00};

constexpr std::array<std::uint32_t, 8> kBodyKinds = {0x01, 0x0C, 0x0D, 0x0E,
                                                     0x0F, 0x09, 0x0C, 0x00};
constexpr std::uint8_t kAimsAtBody = 64;  // bit of a choice
constexpr double kMostFoot_N = 819.2;

// Without a gateway feet and IMU are nodes of their own, one number on both buses.
bridge::BridgeConfig WithBody(bool gateway) {
  bridge::BridgeConfig config = FuzzedRobot(kJoints, gateway);
  if (!gateway) {
    config.body_nodes = {{0, 50, can::BodyPart::kRightFoot},
                         {1, 50, can::BodyPart::kLeftFoot},
                         {1, 51, can::BodyPart::kImu, {0.1, -0.2, 3.0}}};
  }
  return config;
}

class Bench : public WatchedPlant {
 public:
  explicit Bench(bool gateway) : WatchedPlant(WithBody(gateway)) { Start(); }

  void Feed(int bus, const can::Frame& frame) { buses[std::size_t(bus)].feed.push_back(frame); }
  void CheckedCycle(bool with_robot) {
    Advance();
    if (with_robot) SendMessages(false);
    (void)Cycle();
    if (watch.counts().violations > 0) throw Violation(watch.first_violation());
    for (std::size_t j = 0; j < kJoints; ++j) {
      Check(std::isfinite(sensors.position_rad[j]) && std::isfinite(sensors.velocity_rad_s[j]) &&
                std::isfinite(sensors.torque_Nm[j]) &&
                std::isfinite(sensors.motor_position_rad[j]) &&
                std::isfinite(sensors.load_force_N[j]),
            "a sensor value that is not finite");
      Check(sensors.age_us[j] >= 0, "a negative age");
    }
    if (!config.body_nodes.empty()) CheckBody(*plant.body_sensors());
  }
  static void CheckBody(const provider::BodySensors& body) {
    for (const double force_N : body.foot_force_N) {
      Check(std::abs(force_N) <= kMostFoot_N + 1e-9, "a force beyond its field");
    }
    double square = 0.0;
    for (const double c : body.orientation_wxyz) square += c * c;
    Check(std::abs(square - 1.0) < 1e-9, "an orientation that is not of length 1");
    for (std::size_t i = 0; i < 3; ++i) {
      Check(
          std::isfinite(body.acceleration_m_s2[i]) && std::isfinite(body.angular_velocity_rad_s[i]),
          "a value of the IMU that is not finite");
    }
  }
};

double Value(std::uint8_t choice, std::int16_t number) {
  switch (choice % 16) {
    case 0:
      return std::numeric_limits<double>::quiet_NaN();
    case 1:
      return -std::numeric_limits<double>::infinity();
    case 2:
      return 1e300;
    case 3:
      return -1e-300;
    default:
      return 1e-4 * number;
  }
}

void Run(std::span<const std::uint8_t> input, bool gateway) {
  Bench bench(gateway);
  Bytes bytes(input);
  can::Frame last;
  int last_bus = 0;
  for (int cycles = 0; !bytes.empty() && cycles < kMostCycles;) {
    const std::uint8_t op = bytes.Byte();
    switch (static_cast<Op>(op % kOps)) {
      case Op::kAnyFrame:
        last = bytes.Frame();
        last_bus = op >> 3 & 1;
        bench.Feed(last_bus, last);
        break;
      case Op::kAimed: {
        const std::uint8_t choice = bytes.Byte();
        const bridge::JointConfig& c = bench.config.joints[choice % kJoints];
        const bool from_node = c.output && (choice & 4) != 0;
        last = can::Frame{};
        last_bus = c.bus;
        last.id = static_cast<std::uint32_t>(from_node ? c.output->node : c.node) << 5 |
                  kAimedKinds[choice >> 3 & 7];
        const auto& body = bench.config.body_nodes;
        if ((choice & kAimsAtBody) != 0 && !body.empty()) {
          const bridge::BodyNodeConfig& node = body[(choice & 3U) % body.size()];
          last_bus = node.bus;
          last.id = static_cast<std::uint32_t>(node.node) << 5 | kBodyKinds[choice >> 3 & 7];
        }
        last.length = static_cast<std::uint8_t>((op >> 3) == 0 ? 8 : (op >> 3) % 10);
        for (auto& byte : last.data) byte = bytes.Byte();
        bench.Feed(last_bus, last);
        break;
      }
      case Op::kCommand: {
        const std::uint8_t choice = bytes.Byte();
        const std::size_t j = choice % kJoints;
        bench.command.mode[j] = static_cast<ControlMode>(choice >> 2 & 3);
        const std::uint8_t which = bytes.Byte();
        bench.command.motor_torque_Nm[j] = Value(which, bytes.Take<std::int16_t>());
        bench.command.position_rad[j] = Value(which >> 4, bytes.Take<std::int16_t>());
        bench.command.velocity_rad_s[j] = Value(choice >> 4, bytes.Take<std::int16_t>());
        bench.command.valve_open[j] = (op & 8) != 0;
        bench.command.compressor_on[j] = (op & 16) != 0;
        bench.command.vent_open[j] = (op & 32) != 0;
        break;
      }
      case Op::kCycle:
        bench.CheckedCycle(true);
        ++cycles;
        break;
      case Op::kCycleInSilence:
        bench.CheckedCycle(false);
        ++cycles;
        break;
      case Op::kArmAll:  // the way to moving joints is long for chance
        for (std::size_t j = 0; j < kJoints; ++j) {
          bench.command.mode[j] = static_cast<ControlMode>(1 + (j + (op >> 3)) % 3);
          bench.command.motor_torque_Nm[j] = 0.01;
          bench.command.position_rad[j] = 0.3;
          bench.command.velocity_rad_s[j] = -0.5;
        }
        for (int i = 0; i < 12; ++i, ++cycles) bench.CheckedCycle(true);
        break;
      case Op::kFlood:
        for (int i = 0; i < 64 * (op >> 3); ++i) bench.Feed(last_bus, last);
        break;
      case Op::kClearFault:
        bench.plant.ClearFault();
        break;
    }
  }
  bench.CheckedCycle(true);
}

}  // namespace

void RunPlant(std::span<const std::uint8_t> input) { Run(input, false); }
void RunGatewayPlant(std::span<const std::uint8_t> input) { Run(input, true); }

std::vector<Input> PlantSeeds() {
  constexpr auto op = [](Op o, int more = 0) {
    return static_cast<std::uint8_t>(static_cast<int>(o) + kOps * more);
  };
  const auto cycles = [&](Input& seed, int count) {
    seed.insert(seed.end(), static_cast<std::size_t>(count), op(Op::kCycle));
  };
  std::vector<Input> seeds;
  for (int shift = 0; shift < 3; ++shift) {  // every joint in every mode
    Input seed{op(Op::kArmAll, shift)};
    cycles(seed, 20);
    seeds.push_back(seed);
  }
  const auto aimed = [&](Input& seed, std::uint8_t joint, int kind, bool node, int length,
                         std::initializer_list<int> data) {
    seed.push_back(op(Op::kAimed, length == 8 ? 0 : length == 0 ? 10 : length));
    seed.push_back(static_cast<std::uint8_t>(joint | (node ? 4 : 0) | kind << 3));
    for (const int byte : data) seed.push_back(static_cast<std::uint8_t>(byte));
    for (std::size_t i = data.size(); i < 8; ++i) seed.push_back(0);
  };
  for (std::uint8_t joint = 0; joint < kJoints; ++joint) {
    for (int kind = 0; kind < 8; ++kind) {
      for (const bool node : {false, true}) {
        Input seed{op(Op::kArmAll, joint)};
        aimed(seed, joint, kind, node, 8, {1, 0, 0, 0, 8, 0, 0x80, 0x3F});
        cycles(seed, 2);
        aimed(seed, joint, kind, node, 5, {0xFF, 0xFF, 0x7F, 0x7F, 0xFF});
        seed.push_back(op(Op::kFlood, 8));
        cycles(seed, 2);
        seed.push_back(op(Op::kClearFault));
        cycles(seed, 5);
        seeds.push_back(seed);
      }
    }
  }
  // Body nodes: every kind of each, of right and of wrong length; samples of an IMU, whole and with
  // a hole.
  for (std::uint8_t node = 0; node < 3; ++node) {
    Input body{op(Op::kArmAll, node)};
    for (int kind = 0; kind < 8; ++kind) {
      const auto choice = static_cast<std::uint8_t>(kAimsAtBody | node);
      aimed(body, choice, kind, false, 8, {0x10, 0x27, 0xF0, 0xD8, 0, 0x40, kind, 0xF7});
      aimed(body, choice, kind, false, 7, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF});
      cycles(body, 2);
    }
    for (int sequence = 0; sequence < 8; ++sequence) {
      aimed(body, static_cast<std::uint8_t>(kAimsAtBody | node), 0, false, 8, {1, 0, 0, 0, 0, 1});
      for (int kind = 1; kind <= 4; ++kind) {
        if (sequence == 4 && kind == 3) continue;
        aimed(body, static_cast<std::uint8_t>(kAimsAtBody | node), kind, false, 8,
              {sequence, 0x20, 0, 0xE0, 0, 0, sequence, kind == 4 ? sequence % 4 : 7});
      }
      cycles(body, 1);
    }
    seeds.push_back(body);
  }
  Input silence{op(Op::kArmAll)};
  silence.insert(silence.end(), 20, op(Op::kCycleInSilence));
  silence.push_back(op(Op::kClearFault));
  cycles(silence, 20);
  seeds.push_back(silence);
  Input commands{op(Op::kArmAll)};
  for (int i = 0; i < 32; ++i) {
    commands.push_back(op(Op::kCommand, i));
    for (const int byte : {i * 37, 0x40 + 5 * i, i, 3 * i, 5 * i, 7 * i, 11 * i, i})
      commands.push_back(static_cast<std::uint8_t>(byte));
    cycles(commands, 3);
  }
  seeds.push_back(commands);
  Input any{op(Op::kArmAll)};
  can::Frame odd;
  odd.id = 0x3FFFFFFF;
  odd.length = 255;
  odd.extended = odd.remote = true;
  any.push_back(op(Op::kAnyFrame));
  Append(any, odd);
  cycles(any, 2);
  seeds.push_back(any);
  // In a gateway's name, on its bus: a state of its own, whole and with a hole.
  for (const int missing : {-1, 5}) {
    Input state{op(Op::kArmAll, 1)};
    int number = 0;
    can::CompactState content;
    content.position_turns.fill(3.25);
    for (const can::Frame& frame : can::EncodeState(48, content)) {
      if (number++ == missing) continue;
      state.push_back(op(Op::kAnyFrame, 1));
      Append(state, frame);
    }
    cycles(state, 5);
    seeds.push_back(state);
  }
  return seeds;
}

}  // namespace sinew::fuzz
