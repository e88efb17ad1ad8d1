// Joints behind CAN as a state provider's plant: commands to frames, frames to sensors.
//
// A joint (can_joint.h) is a motor controller (ODrive CANSimple) and, where there is one, a sensor
// node at its output. This class has the buses: it distributes what is received, waits for
// requested estimates, and keeps the order of a cycle.
//
// Feet and IMU come from a gateway or from nodes of their own (body_measurement.h). The start does
// not wait for these, and no joint stops for them: without them the sensors are not valid.
//
// Every cycle carries a setpoint to each joint, so that the controllers' watchdogs are fed while
// the bridge lives. A joint with a fault idles; what the others do is the provider's (guard.h).
//
// One thread. Step allocates only when a fault's message is written.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bridge/can/transport/transport.h"
#include "bridge/joints/body_measurement.h"
#include "bridge/joints/bus_statistics.h"
#include "bridge/joints/can_joint.h"
#include "bridge/joints/compact_link.h"
#include "bridge/joints/exchange.h"
#include "bridge/joints/joint_config.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {

class CanPlant : public provider::Plant {
 public:
  // The transports, one per bus, must outlive it. Throws std::invalid_argument naming joint and
  // value.
  CanPlant(const BridgeConfig& config, std::vector<can::Transport*> transports);
  CanPlant(const CanPlant&) = delete;
  CanPlant& operator=(const CanPlant&) = delete;

  int joint_count() const override { return static_cast<int>(joints_.size()); }
  std::string joint_name(int joint) const override {
    return config_.joints[static_cast<std::size_t>(joint)].name;
  }
  bool live() const override { return config_.live; }
  std::uint32_t measured_flags() const override;
  std::string ArmRefusal() const override { return config_.arm_refusal; }
  // Listens for another master of the same nodes, which gets nothing from us; clears the
  // controllers' errors, waits until every node has reported. Throws std::runtime_error naming whom
  // another one commands, or what stayed silent.
  void Reset(provider::PlantSensors* sensors) override;
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;
  bool acts_at_once() const override { return true; }
  // Sends the cycle's frames; the next Step then only reads. Without it, Step sends them.
  void Act(const provider::PlantCommand& command, double period_s) override;
  std::int64_t idle_reported_ns() const override;
  const provider::BusReport* bus_report() const override { return &statistics_.report(); }
  const provider::BodySensors* body_sensors() const override {
    return has_body_ ? &body_ : nullptr;
  }

  // The operator's reset: errors of the controllers and reported faults are cleared. What is still
  // wrong is a fault again at the next Step.
  void ClearFault() override;

  // The last frames: neutral setpoints, axes idle, relays off. None where there was none before.
  void ShutDown() noexcept override;

  types::FaultCause fault(int joint) const {
    return joints_[static_cast<std::size_t>(joint)].fault().cause();
  }
  // In the order of the configuration.
  std::span<const BodyMeasurement> body_nodes() const { return body_nodes_; }
  std::uint64_t malformed() const { return malformed_; }  // frames of ours that could not be read

 private:
  enum class Owner { kNobody, kAxis, kSensorNode, kGateway, kBodyNode };
  struct Node {
    Owner owner = Owner::kNobody;
    std::size_t index = 0;  // joint, gateway or body node
  };

  std::int64_t now_ns() const { return transports_.front()->now_ns(); }
  can::Transport& bus_of(const CanJoint& joint) const {
    return *transports_[static_cast<std::size_t>(joint.config().bus)];
  }

  void Drain();
  void Take(int bus, const can::Received& received);
  void TakeFromGateway(std::size_t gateway, const can::Received& received);
  void ListenForMaster();
  void AwaitAllNodes();
  // Nothing is missing of what was requested since then, or its time is over.
  void AwaitAnswers(std::int64_t cycle_start_ns);
  bool AllAnswered(std::int64_t cycle_start_ns) const;
  bool AsksIq(std::size_t joint) const;
  void AssessJoints();
  void PostReferences();
  void Flush() { outbox_.Flush(transports_); }
  void Fill(provider::PlantSensors* sensors);
  void FillBody(std::int64_t now_ns);
  void FillBodyFromGateway(std::int64_t now_ns);
  void UpdateStatistics(std::int64_t start_ns);

  const BridgeConfig config_;
  std::vector<can::Transport*> transports_;
  FrameOutbox outbox_;
  std::vector<CompactLink> links_;        // per gateway
  std::vector<RequestTimer> references_;  // per gateway: sent, no state since
  std::vector<CanJoint> joints_;
  std::vector<int> turns_;                   // per joint: its turn among those of its bus
  std::vector<std::array<Node, 64>> nodes_;  // per bus and node number
  BusStatistics statistics_;
  std::vector<BodyMeasurement> body_nodes_;
  bool has_body_ = false;
  provider::BodySensors body_;
  std::uint64_t cycle_ = 0;
  bool commands_ = false;  // the bus is ours: frames were sent
  bool acted_ = false;
  double acted_us_ = 0.0;  // work of Act, for the report
  std::uint64_t malformed_ = 0;
};

}  // namespace sinew::bridge
