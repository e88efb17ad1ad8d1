// The messages that a state provider publishes in a cycle: joint_state and actuator_state, and
// bus_status, foot_force and imu where the plant has them, sim_truth of simulated plants,
// sim_body_truth of those on a floating base. Units and signs as in idl/. Thread: the provider's
// loop.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/sensors.h>
#include <sinew_idl/simulation.h>

#include <cstdint>
#include <optional>

#include "components/base/types/message_header.h"
#include "components/base/types/robot_state.h"
#include "components/robot/provider/plant.h"
#include "components/robot/provider/simulated_plant.h"
#include "components/topics/node/node.h"

namespace sinew::provider {

class StatePublisher {
 public:
  // The plant must outlive it. Throws DdsError.
  StatePublisher(node::Node& node, const Plant& plant);

  // joint_state goes out after actuator_state, the body's sensors and the truth: it is the trigger
  // of every participant's loop.
  void Publish(const types::MessageHeader& header, types::RobotState state,
               const types::Fault& fault, bool last_tick, double period_s,
               const PlantSensors& sensors);

  // Monotonic time at the last write of joint_state.
  std::int64_t written_ns() const { return written_ns_; }
  std::uint64_t write_failures() const { return write_failures_; }

 private:
  void FillJointState(const msg::Header& header, const PlantSensors& sensors);
  void FillActuatorState(const msg::Header& header, const PlantSensors& sensors);
  void PublishBody(const msg::Header& header, const BodySensors& body);
  void PublishBus(const msg::Header& header, const BusReport& report);
  void Count(node::WriteStatus status) {
    if (status != node::WriteStatus::kOk) ++write_failures_;
  }

  const Plant& plant_;
  const SimulatedPlant* simulated_;  // the plant, where it is a simulation
  node::Writer<msg::JointState> joint_state_;
  node::Writer<msg::ActuatorState> actuator_state_;
  std::optional<node::Writer<msg::BusStatus>> bus_status_;
  std::optional<node::Writer<msg::FootForce>> foot_force_;
  std::optional<node::Writer<msg::Imu>> imu_;
  std::optional<node::Writer<msg::SimTruth>> sim_truth_;
  std::optional<node::Writer<msg::SimBodyTruth>> sim_body_truth_;
  msg::JointState joints_;
  msg::ActuatorState actuators_;
  std::optional<std::int64_t> last_stamp_ns_;  // of the cycle before
  std::int64_t written_ns_ = 0;
  std::uint64_t write_failures_ = 0;
};

}  // namespace sinew::provider
