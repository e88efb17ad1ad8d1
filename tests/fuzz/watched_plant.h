// The bridge's plant on buses in memory, with a robot that answers and a watch on every frame: what
// the fuzz harness, the tests of the watch, the soak run and the speed measurement share. Time is
// simulated. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bridge/joints/can_plant.h"
#include "tests/fuzz/live_robot.h"
#include "tests/fuzz/plant_watch.h"

namespace sinew::fuzz {

// Of the cycles that everything here runs in.
inline constexpr double kPeriod_s = 1.0 / 240.0;
inline constexpr std::int64_t kPeriod_ns = 4'166'667;

// A robot to fuzz: joints on two buses with the same node numbers on both, so that a frame on the
// wrong bus would reach a joint; all three firmwares, both directions, with and without sensor
// nodes.
// With a gateway those of the second bus are behind it, node 48.
bridge::BridgeConfig FuzzedRobot(int joints, bool gateway = false);

// A bus that hands out what was fed and passes both directions to the watch. Time is the owner's;
// only a Receive that waits lets it pass.
class FedBus : public can::Transport {
 public:
  FedBus(int bus, std::int64_t& now_ns, PlantWatch* watch)
      : bus_(bus), now_ns_(now_ns), watch_(watch) {
    feed.reserve(8192);
    sent.reserve(256);
  }

  can::SendStatus Send(const can::Frame& frame) noexcept override;
  bool Receive(std::chrono::nanoseconds timeout, can::Received* received) noexcept override;
  can::Link link() const noexcept override { return can::Link::kUp; }
  can::TransportCounters counters() const noexcept override { return counters_; }
  std::int64_t now_ns() const noexcept override { return now_ns_; }
  const std::string& name() const noexcept override { return name_; }

  // Forgets what was not read: a full socket does, too.
  void Clear() {
    feed.clear();
    next = 0;
  }

  std::vector<can::Frame> feed;
  std::size_t next = 0;
  std::vector<can::Frame> sent;   // since the owner cleared it
  std::function<void()> on_wait;  // the plant waits and nothing is there: the owner may feed

 private:
  int bus_;
  std::int64_t& now_ns_;
  PlantWatch* watch_;
  can::TransportCounters counters_;
  std::string name_ = "fed";
};

class WatchedPlant {
 public:
  static constexpr int kBuses = 2;

  explicit WatchedPlant(const bridge::BridgeConfig& configuration);
  WatchedPlant(const WatchedPlant&) = delete;
  WatchedPlant& operator=(const WatchedPlant&) = delete;

  // The plant's Reset; the robot answers while it waits.
  void Start();
  // The robot's messages of this moment into the feeds of both buses.
  void SendMessages(bool all);
  // A period passes.
  void Advance() { now_ns += kPeriod_ns; }
  // Act and Step with `command` and what was fed, watched; `inside` is called after Act, before the
  // watch ends. The robot takes what was sent. Returns how many frames were not read.
  std::size_t Cycle(const std::function<void()>& inside = {});

  const bridge::BridgeConfig config;
  std::int64_t now_ns = 1'000'000'000;
  PlantWatch watch;
  LiveRobot robot;
  std::array<FedBus, kBuses> buses;
  bridge::CanPlant plant;
  provider::PlantCommand command;
  provider::PlantSensors sensors;
};

}  // namespace sinew::fuzz
