#include "tests/fuzz/watched_plant.h"

namespace sinew::fuzz {

bridge::BridgeConfig FuzzedRobot(int joints, bool gateway) {
  bridge::BridgeConfig config;
  config.bitrate_bit_s = {1e6, 1e6};
  const int per_bus = (joints + 1) / 2;
  for (int j = 0; j < joints; ++j) {
    bridge::JointConfig joint;
    joint.name = "joint" + std::to_string(j);
    joint.bus = j / per_bus;
    joint.node = 1 + j % per_bus;
    joint.firmware = static_cast<can::Firmware>(j % 3);
    joint.direction = j % 2 == 0 ? 1 : -1;
    joint.gear_ratio = j % 4 == 3 ? 1.0 : 50.0;
    joint.zero_rev = 0.5 * j;
    joint.torque_constant_Nm_A = 0.0159155;
    joint.controller_torque_constant_Nm_A = 8.27 / 600;
    joint.limits = {0.2 + 0.01 * j, 25.0, 4.0, -1.5, 1.5, 0.2, 90.0};
    if (j % 2 == 0) joint.output = bridge::OutputNode{joint.node + 32, j % 4 == 0 ? 1 : -1, 0.25};
    config.joints.push_back(joint);
  }
  if (gateway) {
    bridge::GatewayConfig behind{1, 48, {}};
    for (int j = per_bus; j < joints; ++j) behind.joints.push_back(j);
    config.gateways.push_back(behind);
  }
  return config;
}

can::SendStatus FedBus::Send(const can::Frame& frame) noexcept {
  ++counters_.sent;
  sent.push_back(frame);
  if (watch_ != nullptr) watch_->Sent(bus_, frame, now_ns_);
  return can::SendStatus::kOk;
}

bool FedBus::Receive(std::chrono::nanoseconds timeout, can::Received* received) noexcept {
  if (next >= feed.size()) {
    if (timeout.count() <= 0) return false;
    now_ns_ += timeout.count();
    if (on_wait) on_wait();
    if (next >= feed.size()) return false;
  }
  const can::Frame& frame = feed[next++];
  ++counters_.received;
  if (watch_ != nullptr) watch_->Received(bus_, frame, now_ns_);
  *received = {frame, now_ns_};
  return true;
}

WatchedPlant::WatchedPlant(const bridge::BridgeConfig& configuration)
    : config(configuration),
      watch(config),
      robot(config),
      buses{FedBus(0, now_ns, &watch), FedBus(1, now_ns, &watch)},
      plant(config, {&buses[0], &buses[1]}) {}

void WatchedPlant::Start() {
  buses[0].on_wait = [this] { SendMessages(true); };
  plant.Reset(&sensors);
  buses[0].on_wait = nullptr;
}

void WatchedPlant::SendMessages(bool all) {
  for (int bus = 0; bus < kBuses; ++bus) {
    robot.SendMessages(bus, 1e-9 * static_cast<double>(now_ns), all, &buses[std::size_t(bus)].feed);
  }
}

std::size_t WatchedPlant::Cycle(const std::function<void()>& inside) {
  watch.Begin(plant, command, kPeriod_s);
  plant.Act(command, kPeriod_s);
  if (inside) inside();
  watch.End();
  plant.Step(command, kPeriod_s, &sensors);
  std::size_t unread = 0;
  for (int bus = 0; bus < kBuses; ++bus) {
    FedBus& fed = buses[std::size_t(bus)];
    for (const can::Frame& frame : fed.sent) robot.Take(bus, frame);
    fed.sent.clear();
    unread += fed.feed.size() - fed.next;
    fed.Clear();
  }
  return unread;
}

}  // namespace sinew::fuzz
