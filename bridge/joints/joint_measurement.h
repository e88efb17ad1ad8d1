// The last reports of a joint's controller and sensor node, in the joint's convention.
//
// Output angle q, motor angle m (at the shaft), controller's revolutions r:
//
//     m = direction * 2 pi * (r - zero_rev - home_rev)
//     q = node direction * (angle - zero_rad), or m / gear_ratio without a sensor node
//
// Estimates that jump further than the joint can turn are a fault (kEncoderJump): more than the
// overspeed limit or the last velocity allows in the time between, and a quarter turn. The output's
// angle (kOutputJump) may in addition be thrown through the play, and kOutputJump_rad: 30 steps of
// a 14 bit encoder.
//
// Stamps are those of the frames on the transport's clock; 0: nothing came since the start.
// Pure; one thread; allocates only for the text of a fault.
#pragma once

#include <cstdint>
#include <string>

#include "bridge/can/codec.h"
#include "bridge/can/sensor_node.h"
#include "bridge/can/transport/transport.h"
#include "bridge/joints/joint_config.h"

namespace sinew::bridge {

class FaultLatch;

inline constexpr double kOutputJump_rad = 0.0115;

enum class Taken {
  kUnused,     // a message that the bridge does not use
  kMalformed,  // too short, or a value that is not finite: nothing changed
  kStored,
  kEstimates,  // stored; answers a request for estimates
  kIq,         // stored; answers a request for Iq
};

struct JointMeasurement {
  explicit JointMeasurement(const JointConfig& joint) : config(&joint) {}

  // A frame of the joint's controller. Error codes of motor, encoder and controller are appended to
  // the fault they explain.
  Taken TakeFromAxis(const can::Received& received, FaultLatch* fault);
  // A frame of the joint's sensor node.
  Taken TakeFromNode(const can::Received& received, FaultLatch* fault);
  void TakeEstimates(const can::EncoderEstimates& news, std::int64_t stamp_ns, FaultLatch* fault);

  // The controller's errors are cleared now; a heartbeat up to this stamp is from before that.
  void ClearErrors(std::int64_t until_ns);

  bool closed_loop() const { return heartbeat.axis_state == can::AxisState::kClosedLoopControl; }
  double motor_position_rad() const;
  double motor_velocity_rad_s() const;
  double position_rad() const;  // output
  double velocity_rad_s() const;
  // Output angle by the motor's encoder.
  double motor_position_at_output_rad() const { return motor_position_rad() / config->gear_ratio; }
  // The controller's revolutions at an output angle.
  double Revolutions(double output_rad) const;
  // Stamp of the oldest of the measurements that make up the joint's state.
  std::int64_t motion_ns() const;  // of position and velocity the older
  std::int64_t oldest_ns() const;
  // Sources that sent nothing since the start, as "no heartbeat of axis node 3"; empty: none.
  std::string Missing() const;

  // Raises kOutputJump; `output` is the new one.
  void AssessOutputStep(const can::OutputEncoder& before, std::int64_t stamp_ns,
                        FaultLatch* fault) const;

  const JointConfig* config;
  can::Heartbeat heartbeat;
  can::EncoderEstimates estimates;
  double iq_A = 0.0;  // in the controller's direction
  can::OutputEncoder output;
  can::JointSensors sensors;
  double home_rev = 0.0;  // whole turns found by homing
  std::int64_t heartbeat_ns = 0;
  std::int64_t estimates_ns = 0;
  std::int64_t iq_ns = 0;
  std::int64_t output_ns = 0;
  std::int64_t sensors_ns = 0;
  std::int64_t errors_cleared_ns = 0;
};

}  // namespace sinew::bridge
