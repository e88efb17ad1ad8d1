// A bridge's plant and virtual axes on buses in memory: simulated time, every frame seen.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bridge/joints/can_plant.h"
#include "bridge/virtual_axes/virtual_axes.h"
#include "components/base/types/control_mode.h"
#include "tests/bridge/joints/one_joint.h"
#include "tests/bridge/virtual_axes/rotors.h"
#include "tests/support/memory_can.h"

namespace sinew::bridge {

using test::Rotors;
using types::ControlMode;

inline constexpr double kPeriod_s = 1.0 / 240.0;
inline constexpr std::int64_t kPeriod_ns = 4'166'667;

// Robot of `joints` joints on `buses` buses, and everything around it.
struct BenchSetup {
  int joints = 1;
  int buses = 1;
  bool output_nodes = true;
  Estimates estimates = Estimates::kCyclic;
  int direction = 1;
  double zero_rev = 0.0;
  double watchdog_s = 0.1;
  double bitrate_bit_s = 1e6;
  bool gateway = false;  // all joints behind the gateway of node 48 on the first bus
  double rate_Hz = 240.0;
  provider::SimulatedPlant* plant = nullptr;  // instead of the rotors
};

class Bench {
 public:
  static constexpr int kGatewayNode = 48;

  explicit Bench(const BenchSetup& setup = {}) : setup_(setup), rotors(setup.joints) {
    for (int b = 0; b < setup.buses; ++b) {
      buses.push_back(
          std::make_unique<can::MemoryBus>(can::BusConfig{.bitrate_bit_s = setup.bitrate_bit_s}));
    }
    config.bitrate_bit_s.assign(static_cast<std::size_t>(setup.buses), setup.bitrate_bit_s);
    config.timing.estimates = setup.estimates;
    const int per_bus = (setup.joints + setup.buses - 1) / setup.buses;
    for (int j = 0; j < setup.joints; ++j) {
      JointConfig joint;
      joint.name = "joint" + std::to_string(j);
      joint.bus = j / per_bus;
      joint.node = j + 1;
      joint.direction = setup.direction;
      joint.zero_rev = setup.zero_rev;
      joint.gear_ratio = 100.0;
      joint.torque_constant_Nm_A = Rotors::kTorqueConstant_Nm_A;
      joint.controller_torque_constant_Nm_A = 8.27 / 600;
      joint.limits = {0.398, 25.0, 4.0, -1.5, 1.5, 0.2, 90.0};
      if (setup.output_nodes) joint.output = OutputNode{j + 33, 1, 0.25};
      config.joints.push_back(joint);

      virtual_axes::AxisConfig axis;
      axis.bus = joint.bus;
      axis.node = joint.node;
      axis.joint = j;
      axis.direction = setup.direction;
      axis.zero_rev = setup.zero_rev;
      axis.gear_ratio = 100.0;
      axis.watchdog_s = setup.watchdog_s;
      axis.rates.encoder_ms = setup.estimates == Estimates::kCyclic && !setup.gateway ? 2 : 0;
      axes_config.axes.push_back(axis);
      if (setup.output_nodes) {
        virtual_axes::SensorNodeConfig node;
        node.bus = joint.bus;
        node.node = j + 33;
        node.joint = j;
        node.zero_rad = 0.25;
        axes_config.nodes.push_back(node);
      }
    }
    if (setup.gateway) {
      GatewayConfig gateway{0, kGatewayNode, {}};
      virtual_axes::GatewayConfig virtual_gateway{0, kGatewayNode, {}};
      for (int j = 0; j < setup.joints; ++j) {
        gateway.joints.push_back(j);
        virtual_gateway.axes.push_back(j + 1);
      }
      config.gateways.push_back(gateway);
      axes_config.gateways.push_back(virtual_gateway);
    }
  }

  void Start() {
    Prepare();
    plant->Reset(&sensors);
  }
  // All but hearing the axes for the first time.
  void Prepare() {
    std::vector<can::Transport*> bridge_ends, axes_ends;
    for (std::size_t b = 0; b < buses.size(); ++b) {
      ends.push_back(buses[b]->Join("bridge", ReceiveFilters(config, static_cast<int>(b))));
      bridge_ends.push_back(ends.back().get());
      ends.push_back(buses[b]->Join("axes"));
      axes_ends.push_back(ends.back().get());
    }
    axes = std::make_unique<virtual_axes::VirtualAxes>(
        axes_config, setup_.plant != nullptr ? *setup_.plant : rotors, axes_ends);
    axes->Start(0);
    buses[0]->AddAgent([this] { return axes->next_ns(); },
                       [this](std::int64_t now) { RunAxes(now); });
    if (setup_.gateway) {  // it answers at once, not at the next step
      buses[0]->OnFrame([this](const can::Delivery& d) {
        if (on_frame) on_frame(d);
        answer_ = answer_ || can::ReferenceFrameNumber(kGatewayNode, d.frame) >= 0;
      });
      buses[0]->AddAgent([this] { return answer_ ? buses[0]->now_ns() : kNever_ns; },
                         [this](std::int64_t now) {
                           answer_ = false;
                           axes->Answer(now);
                         });
    }
    plant = std::make_unique<CanPlant>(config, bridge_ends);
  }
  // One cycle of the provider.
  void Step() {
    plant->Step(command, 1.0 / setup_.rate_Hz, &sensors);
    next_ns_ =
        std::max<std::int64_t>(next_ns_ + std::llround(1e9 / setup_.rate_Hz), buses[0]->now_ns());
    for (auto& bus : buses) bus->AdvanceTo(next_ns_);
  }
  void Steps(int count) {
    for (int i = 0; i < count; ++i) Step();
  }
  // Until the joints are in closed loop.
  void Arm(ControlMode mode = ControlMode::kTorque) {
    next_ns_ = buses[0]->now_ns();
    for (std::size_t j = 0; j < config.joints.size(); ++j) command.mode[j] = mode;
    for (int i = 0; i < 100; ++i) {
      Step();
      if (axes->axis_state(0) == can::AxisState::kClosedLoopControl && i > 40) return;
    }
    FAIL() << "not armed";
  }

  std::function<void(const can::Delivery&)> on_frame;  // with a gateway

  bool faulty() const { return sensors.any_fault(); }

  BenchSetup setup_;
  Rotors rotors;
  std::vector<std::unique_ptr<can::MemoryBus>> buses;
  std::vector<std::unique_ptr<can::Transport>> ends;
  BridgeConfig config;
  virtual_axes::VirtualAxesConfig axes_config;
  std::unique_ptr<virtual_axes::VirtualAxes> axes;
  std::unique_ptr<CanPlant> plant;
  provider::PlantCommand command;
  provider::PlantSensors sensors;

 private:
  // Time is the first bus'; the others follow it.
  void RunAxes(std::int64_t now_ns) {
    for (std::size_t b = 1; b < buses.size(); ++b) buses[b]->AdvanceTo(now_ns);
    axes->Run(now_ns);
  }
  static constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t next_ns_ = 0;
  bool answer_ = false;
};

// A bus without others: it hands out `frames` once per cycle and keeps nothing of what is sent but
// `on_send`.
class Deaf : public can::Transport {
 public:
  can::SendStatus Send(const can::Frame& frame) noexcept override {
    if (loses && loses(frame)) return can::SendStatus::kDropped;
    if (on_send) on_send(frame);
    return can::SendStatus::kOk;
  }
  bool Receive(std::chrono::nanoseconds timeout, can::Received* received) noexcept override {
    if (next >= frames.size()) {
      now += timeout.count();
      if (timeout.count() > 0) next = 0;
      return false;
    }
    *received = {frames[next++], now};
    return true;
  }
  can::Link link() const noexcept override { return can::Link::kUp; }
  can::TransportCounters counters() const noexcept override { return {}; }
  std::int64_t now_ns() const noexcept override { return now; }
  const std::string& name() const noexcept override { return name_; }

  std::vector<can::Frame> frames;
  std::size_t next = 0;
  std::int64_t now = 1'000'000;
  std::function<void(const can::Frame&)> on_send;
  std::function<bool(const can::Frame&)> loses;  // finds no space for it; none: never

 private:
  std::string name_ = "deaf";
};

// What CheckBridgeConfig says of it, or "accepted".
inline std::string RefusalOf(const BridgeConfig& config) {
  try {
    CheckBridgeConfig(config);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace sinew::bridge
