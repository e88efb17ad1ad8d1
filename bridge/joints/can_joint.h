// One joint behind CAN: measurement, faults, state machine, limits and exchange put together.
//
//     frames -> JointMeasurement -> AssessFaults -> AxisStateMachine -> limits -> JointExchange
//
// Torque setpoint on the wire, so that the current is T / torque_constant whatever the
// controller's own constant is; joint torque from the measured current:
//
//     setpoint = direction * T * controller_torque_constant / torque_constant
//     torque   = torque_efficiency * gear_ratio * torque_constant * Iq * direction
//
// In position mode the setpoint leaves the measured position at no more than the velocity limit.
// Frames are posted to the exchange's outbox; the caller flushes it. Times are those of the
// transport's clock and come in. One thread; allocates only for the text of a fault.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "bridge/can/sensor_node.h"
#include "bridge/can/transport/transport.h"
#include "bridge/joints/axis_state.h"
#include "bridge/joints/braking.h"
#include "bridge/joints/bus_statistics.h"
#include "bridge/joints/exchange.h"
#include "bridge/joints/faults.h"
#include "bridge/joints/joint_config.h"
#include "bridge/joints/joint_measurement.h"
#include "components/base/types/control_mode.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {

// A joint's part of provider::PlantCommand: setpoints of the drive, relays of the pneumatics.
struct ActuatorCommand {
  types::ControlMode mode = types::ControlMode::kIdle;
  double motor_torque_Nm = 0.0;
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;
  bool valve_open = false;
  bool compressor_on = false;
  bool vent_open = false;
};
ActuatorCommand CommandOf(const provider::PlantCommand& command, std::size_t joint);

class CanJoint {
 public:
  // Configuration, timing and outbox must outlive it; the outbox is the exchange's.
  CanJoint(const JointConfig& config, const BridgeTiming& timing,
           std::unique_ptr<JointExchange> exchange, FrameOutbox* outbox);

  const JointConfig& config() const { return config_; }
  const JointMeasurement& measured() const { return measured_; }
  const FaultLatch& fault() const { return fault_; }
  // Time of the heartbeat that reports an axis, which should be idle, as idle; 0: none did.
  std::int64_t idle_reported_ns() const;
  bool is_polled() const { return exchange_->is_polled(); }

  // As after the constructor.
  void Forget();
  // The same; requests idle and clears the controller's errors.
  void Reset();
  // Once every node has reported: Iq counts from now, and the zero check.
  void Start(std::int64_t now_ns);
  // The operator's reset: clears the controller's errors and a reported fault; homes.
  void ClearFault(std::int64_t now_ns);
  // Neutral setpoint, idle, relays off.
  void ShutDown(std::int64_t now_ns);
  // Faults by the newest measurements; the bus is named in the text of a silent node's fault.
  void Assess(std::int64_t now_ns, const can::Transport& bus);
  // The setpoint of a cycle.
  void Command(const ActuatorCommand& command, double period_s, std::int64_t now_ns);
  void SendNeutral();
  // The relays of the sensor node, where there is one.
  void SendValves(const ActuatorCommand& command);
  void RequestEstimates(std::int64_t now_ns);
  void RequestIq(std::int64_t now_ns);

  struct News {
    bool malformed = false;
    std::optional<double> answer_us = {};  // time from the request that this frame answers
  };
  News TakeFromAxis(const can::Received& received);
  News TakeFromNode(const can::Received& received);
  // Somebody else sent it a setpoint or a request for a state: a fault.
  void HearMaster();
  // The joint's fields of a gateway's state.
  void TakeFromGateway(const can::EncoderEstimates& estimates, double iq_A, std::int64_t stamp_ns);

  // The joint's part of the sensors; from now on its fault counts as reported.
  void Fill(std::size_t joint, std::int64_t now_ns, provider::PlantSensors* sensors);

 private:
  void SendSetpoint(const ActuatorCommand& command, double period_s, std::int64_t now_ns);

  const JointConfig& config_;
  const BridgeTiming& timing_;
  std::unique_ptr<JointExchange> exchange_;
  FrameOutbox* outbox_;
  JointMeasurement measured_;
  FaultLatch fault_;
  EncoderWatch encoders_;
  AxisStateMachine axis_;
  double setpoint_rad_ = 0.0;  // last position setpoint, output
  PositionRange range_;        // where torque may move it
  std::uint8_t valve_sequence_ = 0;
  RequestTimer estimates_request_;
  RequestTimer iq_request_;
};

}  // namespace sinew::bridge
