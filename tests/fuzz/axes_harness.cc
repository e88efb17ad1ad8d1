#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "bridge/virtual_axes/virtual_axes.h"
#include "tests/bridge/virtual_axes/rotors.h"
#include "tests/fuzz/harness.h"
#include "tests/fuzz/property.h"
#include "tests/fuzz/watched_plant.h"

namespace sinew::fuzz {
namespace {

constexpr int kAxes = 3;
constexpr std::int64_t kMs_ns = 1'000'000;
constexpr int kMostSteps = 500;

virtual_axes::VirtualAxesConfig Config() {
  virtual_axes::VirtualAxesConfig config;
  for (int j = 0; j < kAxes; ++j) {
    virtual_axes::AxisConfig axis;
    axis.node = 1 + j;
    axis.joint = j;
    axis.firmware = static_cast<can::Firmware>(j);
    axis.gear_ratio = 100.0;
    axis.encoder_counts_rev = j == 1 ? 4000.0 : 16384.0;
    axis.rates = {20, 2, 5, 10, 10, 10, 10};
    axis.watchdog_s = j == 0 ? 0.05 : 0.0;
    config.axes.push_back(axis);
    virtual_axes::SensorNodeConfig node;
    node.node = 33 + j;
    node.joint = j;
    config.nodes.push_back(node);
  }
  for (const auto& [number, part] :
       {std::pair{50, can::BodyPart::kRightFoot}, std::pair{51, can::BodyPart::kImu}}) {
    virtual_axes::BodyNodeConfig body;
    body.node = number;
    body.part = part;
    config.body_nodes.push_back(body);
  }
  return config;
}

}  // namespace

void RunAxes(std::span<const std::uint8_t> input) {
  test::Rotors rotors(kAxes);
  std::int64_t now_ns = 1'000 * kMs_ns;
  FedBus bus(0, now_ns, nullptr);
  virtual_axes::VirtualAxes axes(Config(), rotors, {&bus});
  axes.Start(now_ns);
  Bytes bytes(input);
  // Numbers a node was ever addressed by: an axis whose number never appeared must stay as it is.
  std::array<bool, 64> addressed{};
  bool renumbered = false;
  for (int steps = 0; steps < kMostSteps; ++steps) {
    const std::uint8_t op = bytes.Byte();
    for (int i = 0; i < op % 8; ++i) {
      can::Frame frame = bytes.Frame();
      if ((op & 8) != 0) {  // aimed: a plain frame to a node of ours
        frame.extended = frame.error = false;
        frame.id = (1 + frame.id / 32 % kAxes + ((op & 16) != 0 ? 32U : 0U)) << 5 | (frame.id & 31);
        frame.length = static_cast<std::uint8_t>(frame.length % 9);
      }
      bus.feed.push_back(frame);
      if (!frame.extended && !frame.error && frame.id <= 0x7FF) {
        addressed[frame.id >> 5] = true;
        renumbered = renumbered || (frame.id & 31) == 0x06;
      }
    }
    now_ns += (1 + (op >> 5)) * kMs_ns;
    axes.Run(now_ns);
    for (const can::Frame& frame : bus.sent) {
      Check(can::IsValid(frame) && !frame.extended && !frame.error && !frame.remote,
            "a virtual axis sent an impossible frame");
    }
    bus.sent.clear();
    bus.Clear();
    for (int j = 0; j < kAxes && !renumbered; ++j) {
      if (addressed[static_cast<std::size_t>(1 + j)]) continue;
      Check(axes.axis_state(j) == can::AxisState::kIdle && axes.input_torque_Nm(j) == 0.0 &&
                rotors.torque_Nm[static_cast<std::size_t>(j)] == 0.0,
            "an axis moved that was not addressed");
    }
    if (bytes.empty()) break;
  }
}

std::vector<Input> AxesSeeds() {
  std::vector<Input> seeds;
  const auto to = [](Input& seed, const can::Frame& frame) {
    seed.push_back(1);
    Append(seed, frame);
  };
  for (int j = 0; j < kAxes; ++j) {
    const auto firmware = static_cast<can::Firmware>(j);
    const auto encode = [&](const auto& message) { return can::Encode(1 + j, message, firmware); };
    Input seed;
    to(seed, encode(can::SetControllerMode{can::ControlMode::kTorque}));
    to(seed, encode(can::SetAxisState{can::AxisState::kClosedLoopControl}));
    to(seed, encode(can::SetInputTorque{0.01}));
    to(seed, encode(can::SetInputVel{1.0, 0.0}));
    to(seed, encode(can::SetControllerMode{can::ControlMode::kVelocity}));
    to(seed, encode(can::SetControllerMode{can::ControlMode::kPosition}));
    to(seed, encode(can::SetInputPos{1.0, 0.0, 0.0}));
    to(seed, encode(can::SetLimits{50.0, 20.0}));
    seed.insert(seed.end(), 20, 0xE0);
    seeds.push_back(seed);
    for (std::uint32_t command = 0; command < 32; ++command) {
      Input each;
      can::Frame frame;
      frame.id = static_cast<std::uint32_t>(1 + j) << 5 | command;
      frame.length = 8;
      frame.data = {8, 0, 0, 0, 0, 0, 0x80, 0x3F};
      to(each, frame);
      to(each, can::EncodeRequest(1 + j, static_cast<can::Command>(command)));
      each.insert(each.end(), 4, 0x20);
      seeds.push_back(each);
    }
  }
  Input far;  // a setpoint at the end of the world, and the question where that is
  to(far, can::Encode(2, can::SetControllerMode{can::ControlMode::kPosition}));
  to(far, can::Encode(2, can::SetAxisState{can::AxisState::kClosedLoopControl}));
  to(far, can::Encode(2, can::SetInputPos{1e30, 0.0, 0.0}));
  for (int i = 0; i < 20; ++i) to(far, can::EncodeRequest(2, can::Command::kGetEncoderCount));
  seeds.push_back(far);
  Input valve;
  to(valve, can::Encode(33, can::ValveCommand{true, true, false, 1, 60}));
  valve.insert(valve.end(), 20, 0xE0);
  seeds.push_back(valve);
  return seeds;
}

}  // namespace sinew::fuzz
