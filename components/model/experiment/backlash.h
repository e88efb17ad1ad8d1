// The play of the gear (5.1.1, Fig 5.1): the motor turns to and fro with a small torque while a
// counter torque holds the link; the difference d = motor/N - output angle goes from one contact to
// the other.
//
// One trial is one period. Published: largest minus smallest d. That has two small biases: the
// extremes of noisy counts (up), and teeth that bend under the motor's torque (up). Here a trial's
// play is the difference of the mean d in the two contacts, and trials at two torques
// determine the compliance c of the contact:
//
//     w = play + c * (|torque up| + |torque down|),  torque = efficiency N Kt Iq
//
// The link rests at much the same angle in every trial, so that the rounding of its encoder does
// not average out over trials (LargestRounding in statistics.h): the intervals have it, with the
// phase of each contact unknown, beside the statistical part.
//
// Trials are separated by the sign of the current, so any recording of the protocol can be used.
#pragma once

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"

namespace sinew::experiment {

struct BacklashPlan {
  int trials = 100;
  double motor_torque_Nm = 0.02;         // published
  double second_motor_torque_Nm = 0.01;  // of every other trial; determines the compliance
  double period_s = 2.5;                 // published
  double hand_N_rad = 150.0;             // the counter torque: a hand that holds the link
  double hand_N_s_rad = 3.0;
  double pressure_bar = 1.617;  // carries the link
};

class BacklashProtocol : public Protocol {
 public:
  explicit BacklashProtocol(const BacklashPlan& plan);
  Start start() const override { return {.pressure_bar = plan_.pressure_bar}; }
  Command Step(const Reading& reading) noexcept override;
  double expected_s() const override { return plan_.trials * plan_.period_s; }
  std::string instruction() const override {
    return "hold the link level against the motor, up and down";
  }

 private:
  BacklashPlan plan_;
};

// Throws std::invalid_argument when there are fewer than 4 trials, or only one torque was used.
Result IdentifyBacklash(const Recording& rows, const RigConstants& rig);

}  // namespace sinew::experiment
