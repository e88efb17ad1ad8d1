// Inertia and damping of the motor alone (4.21)-(4.26).
//
//     Kt Iq = J dw/dt + B w + Tc sign(w)
//
// Kt = 60 / (2 pi KV). The source prints 3/2 Ke with Ke by (4.25), which is inverted; taken
// with Ke = Kt, its factor 3/2 makes J and B larger by a half. Here Kt holds the whole factor.
//
// The motor is uncoupled: with gearbox and link the fit would be of something else. The torque is a
// sum of sines. Two fits are reported:
//   as published: velocity as the drive reports it, differences of rows (4.22), no dry friction.
//     Without Tc, B takes up the dry friction's part along w.
//   with Coulomb friction: angles and current through the same zero-phase low-pass, the angle
//     differentiated twice, a delay between current and angle fitted with them; rows near w = 0
//     left out. Blocks of a second are the trials of the interval.
#pragma once

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"

namespace sinew::experiment {

struct MotorPlan {
  double duration_s = 40.0;
  double torque_Nm = 0.009;  // root mean square at the shaft
  double lowest_Hz = 0.15;
  double highest_Hz = 4.0;
  int sines = 7;
  double ramp_s = 1.0;
  std::uint64_t seed = 1;  // phases
};

class MotorProtocol : public Protocol {
 public:
  explicit MotorProtocol(const MotorPlan& plan);  // throws std::invalid_argument
  Start start() const override { return {.motor_uncoupled = true}; }
  Command Step(const Reading& reading) noexcept override;
  double expected_s() const override { return plan_.duration_s; }
  std::string instruction() const override { return "hands off: the motor turns alone"; }

 private:
  struct Sine {
    double rad_s, phase_rad, torque_Nm;
  };
  MotorPlan plan_;
  std::vector<Sine> sines_;
};

// Throws std::invalid_argument: too short, or the output moved (the motor was coupled).
Result IdentifyMotor(const Recording& rows, const RigConstants& rig);

}  // namespace sinew::experiment
