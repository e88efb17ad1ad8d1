// The two encoders of a joint against each other and against themselves, while it moves.
//
// D = motor angle / N - output angle. The gear allows D to change by its free play and its
// compliance, not more; and who turns, turns both encoders. From that, with
//
//     allowance = compliance + tolerance of the zero check      declared; noise and resolution are
//                                                               part of the tolerance
//     lag       = fastest of late (10 ms + age of the stamps)   the frames of the two encoders
//     waited
//                                                               for the bus for different times
//
// follow the statistics of the rules in faults.cc, in rad at the output:
//
//     still   how far one encoder has turned while the other reported the same angle again and
//             again, less play + allowance + lag, which a healthy joint stays below
//     slip    |D| less half the play + allowance + lag: beyond it for kSlipPersists only when
//             something is wrong
//     grows   since slip is above 0, D has changed by kGrows of what the motor turned, and by more
//             than the tolerance
//     own     how far the motor's velocity says it has turned while its angle stood still; for
//             joints without an output encoder too
//
// A frozen encoder is found by `still`; an encoder or gear that slipped by `slip`; one that counts
// wrong (scale, lost counts, wrong sign) by a slip that grows: the output does not turn as fast as
// the motor, though it is not in the play. That is decided by angles: velocities of sensor nodes
// are filtered, and lag behind by more than the play in a reversal. Steps of an angle are found
// where it arrives (JointMeasurement). Without a zero check the play is not declared, and only
// `own` is watched.
//
// Pure; one thread; allocates nothing.
#pragma once

#include <cstdint>

#include "bridge/joints/joint_measurement.h"

namespace sinew::bridge {

// The longest wait of a frame for its place on the bus; as for jumps.
inline constexpr double kEncoderLag_s = 0.01;
// The lag of a fast motion is caught up with after some times the lag.
inline constexpr double kLagForgets_s = 0.1;
// Two lost frames of a sensor node that sends every 20 ms (estimate_timeout_ms) are no slip.
inline constexpr double kSlipPersists_s = 0.06;
// A scale that is off by less is named a slip: it takes tens of strokes to leave the play.
inline constexpr double kGrows = 0.1;
// As kJump_rev of JointMeasurement: what a motor may be off by its own velocity.
inline constexpr double kOwn_rev = 0.25;

class EncoderWatch {
 public:
  explicit EncoderWatch(const JointConfig& joint) : joint_(&joint) {}

  // Begins anew: the joint was idle, and may have been turned.
  void Restart() { *this = EncoderWatch(*joint_); }
  // Once or more a cycle with the newest measurements.
  void Update(const JointMeasurement& measured, std::int64_t now_ns);

  // Above 0: the encoders are not plausible.
  double output_still_rad() const { return output_still_rad_; }
  double motor_still_rad() const { return motor_still_rad_; }
  double slip_rad() const { return slip_rad_; }
  double slip_s() const { return slip_s_; }  // for how long slip_rad() has been above 0
  bool slip_grows() const { return grows_; }

 private:
  // An encoder that reports the same angle, and where the other one was when that began.
  struct Stillness {
    bool known = false;
    double angle_rad = 0.0, other_rad = 0.0;
    double TravelOfOther(double angle_now_rad, double other_now_rad);
  };

  void UpdateSlip(double motor_rad, double output_rad, double allowed_rad, double step_s);

  const JointConfig* joint_;
  std::int64_t motor_ns_ = 0, output_ns_ = 0, now_ns_ = 0;
  Stillness output_, motor_;
  double own_rev_ = 0.0;
  double fastest_rad_s_ = 0.0;                               // of late
  double slip_motor_rad_ = 0.0, slip_difference_rad_ = 0.0;  // when the slip began
  double output_still_rad_ = -1.0, motor_still_rad_ = -1.0;
  double slip_rad_ = -1.0, slip_s_ = 0.0;
  bool grows_ = false;
};

}  // namespace sinew::bridge
