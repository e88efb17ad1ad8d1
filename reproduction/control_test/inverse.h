// The true inverse of the surrogate along a reference, by iteration in process: the bound that no
// compensator can beat by much.
//
// The specimen without sensor noise runs under the PID C and a torque over time u_k. With P the
// plant, e = (r - P u) / (1 + P C), so what u_k lacks is (1 / P + C) e_k. C e_k is the PID's part
// fb_k of the command, and 1 / P is near J s^2 + B s with the declared inertia and viscous
// friction:
//
//     u_{k+1} = u_k + gain Q [fb_k + (J d^2e_k/dt^2 + B de_k/dt) / (N efficiency)],   u_0 = 0
//
// Q: low pass without phase. What the declared model gets wrong (dry friction, play, gas) slows the
// rounds down, and does not change where they end. The run with the least error is kept. It knows
// the future and the physics: a bound, not a controller. Throws std::invalid_argument.
#pragma once

#include <vector>

#include "components/robot/control/compensator.h"
#include "sim/surrogate/parameters.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::control_test {

struct InverseConfig {
  tune::ClosedLoopConfig loop;  // its first joint has the PID and a model
  surrogate::RigParameters rig;
  int iterations = 20;
  double cutoff_Hz = 10.0;  // Q
  double gain = 0.7;
};

struct Inverse {
  control::RecordedTorque torque;
  double mse_rad2 = 0.0;                  // of the kept round, noise-free
  std::vector<double> mse_by_round_rad2;  // the first is the PID's alone
};

// The rig with every sensor's noise off and encoders of 26 bits.
surrogate::RigParameters WithoutNoise(surrogate::RigParameters rig);

Inverse InvertSurrogate(const InverseConfig& config);

}  // namespace sinew::control_test
