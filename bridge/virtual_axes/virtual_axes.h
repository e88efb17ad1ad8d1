// Motor controllers, sensor nodes, gateways and body nodes that exist only as frames, with a
// simulated plant behind them.
//
// The nodes are models of their own (axis_model.h, sensor_node_model.h, gateway_model.h,
// body_node_model.h). This class hands them the frames of their number, steps the plant (a
// provider::SimulatedPlant: the surrogate, a world, or a test's) at a fixed period with what they
// demand, and sends what they answer.
//
// Pure but for its transports: time comes from Run's argument. One thread.
#pragma once

#include <cstdint>
#include <vector>

#include "bridge/can/transport/transport.h"
#include "bridge/virtual_axes/axes_config.h"
#include "bridge/virtual_axes/axis_model.h"
#include "bridge/virtual_axes/body_node_model.h"
#include "bridge/virtual_axes/gateway_model.h"
#include "bridge/virtual_axes/sensor_node_model.h"
#include "components/robot/provider/simulated_plant.h"

namespace sinew::virtual_axes {

class VirtualAxes {
 public:
  // The plant and the transports must outlive it. Throws as CheckVirtualAxesConfig.
  VirtualAxes(const VirtualAxesConfig& config, provider::SimulatedPlant& plant,
              std::vector<can::Transport*> transports);

  // Starts at this time.
  void Start(std::int64_t now_ns);
  // The time at which Run is to be called next.
  std::int64_t next_ns() const { return next_step_ns_; }
  // Takes what has arrived, moves the plant up to `now_ns`, sends what is due. After a pause longer
  // than 50 ms the plant's time stands still for the rest of it.
  void Run(std::int64_t now_ns);
  // Takes what has arrived and answers requests, without moving anything: to be called between
  // steps.
  void Answer(std::int64_t now_ns);

  // The hand at the end of a joint's link, positive presses down; what is not finite is no hand.
  void SetHand(int joint, double force_N);

  // For tests and for tools that stage failures.
  void SetAxisError(int axis, std::uint32_t error) { At(axis).Fail(error); }
  void Silence(int axis, bool silent) { At(axis).Silence(silent); }
  void FalsifyMotorEncoder(int axis, const EncoderFault& fault) { At(axis).Falsify(fault); }
  void FalsifyOutputEncoder(int node, const EncoderFault& fault) {
    nodes_.at(static_cast<std::size_t>(node)).Falsify(fault);
  }
  void FalsifyBodyNode(int node, const BodyFault& fault) {
    body_nodes_.at(static_cast<std::size_t>(node)).Falsify(fault);
  }
  // The plant is held where it started (axes_config.h).
  bool held() const { return held_; }
  can::AxisState axis_state(int axis) const { return At(axis).state(); }
  std::uint32_t axis_error(int axis) const { return At(axis).error(); }
  double input_torque_Nm(int axis) const { return At(axis).input_torque_Nm(); }
  bool valve_open(int node) const { return nodes_.at(static_cast<std::size_t>(node)).valve_open(); }
  std::uint64_t frames_taken() const { return frames_taken_; }
  std::uint64_t steps() const { return steps_; }
  const provider::PlantSensors& sensors() const { return sensors_; }

 private:
  AxisModel& At(int axis) { return axes_.at(static_cast<std::size_t>(axis)); }
  const AxisModel& At(int axis) const { return axes_.at(static_cast<std::size_t>(axis)); }
  void Take(int bus, const can::Frame& frame, std::int64_t now_ns);
  void SendDue(std::int64_t now_ns);
  // Lets the plant go when all axes have been in closed-loop control for long enough.
  void WatchHold();
  void StepPlant();
  void Send(int bus, const can::Frame& frame);

  VirtualAxesConfig config_;
  provider::SimulatedPlant& plant_;
  std::vector<can::Transport*> transports_;
  std::vector<AxisModel> axes_;
  std::vector<SensorNodeModel> nodes_;
  std::vector<GatewayModel> gateways_;
  std::vector<BodyNodeModel> body_nodes_;
  std::int64_t step_ns_ = 0;
  std::int64_t next_step_ns_ = 0;
  bool held_ = false;
  std::int64_t hold_ends_ns_ = 0;  // unless an axis leaves closed-loop control before
  provider::PlantCommand command_;
  provider::Disturbance disturbance_;
  provider::PlantSensors sensors_;
  std::uint64_t frames_taken_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace sinew::virtual_axes
