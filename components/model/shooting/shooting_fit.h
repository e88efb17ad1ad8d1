// A joint model fitted to recordings by simulation: multiple shooting over pieces (pieces.h).
//
//     minimise  sum |row / sigma|^2 + sum |gap / loud|^2 + sum |state|^2 + sum (zero / deviation)^2
//               + sum ((theta - declared) / tolerance)^2
//
// by Levenberg and Marquardt's method (Ceres Solver) within the physical range of each parameter.
// gap: what does not continue from a piece to the next, in prior deviations of the state. sigma: at
// first the noise of the angle, then as loud as sums of rows over whole pieces are, so that the
// declared tolerances count against what the model leaves; loud: the same of the gaps, 1 at first.
// Derivatives are differences of simulations: friction acts as an impulse, so that a path depends
// continuously on its parameters through contacts and sticking as well. Pure; allocates; one
// thread.
#pragma once

#include <vector>

#include "components/model/shooting/pieces.h"

namespace sinew::shooting {

// A parameter that is fitted, counted in units of `scale` from `mean`.
struct Parameter {
  int term = 0, index = 0;
  bool nonlinear = false;
  double mean = 0.0, scale = 1.0;
  double precision = 0.0;           // of the prior of that count: 1, or 0: flat
  double lower = 0.0, upper = 0.0;  // of the value
};

// Parameters of the model's balance: linear ones that are not fixed, and the continuous nonlinear
// ones of added terms. declared: the first terms of the model, with the values that the priors are
// about.
std::vector<Parameter> FreeParameters(const Recordings& recordings,
                                      const actuator::JointModel& model,
                                      const actuator::JointModel& declared);
double& ValueOf(const Parameter& parameter, actuator::JointModel* model);

struct Fit {
  actuator::JointModel model;  // half widths as they were
  Start start;
  Eigen::VectorXd residual;  // rows
  double rms = 0.0;          // of it, rad or m
};

// From the model's values on. Throws std::invalid_argument: a model that cannot be simulated.
Fit FitBySimulation(const Recordings& recordings, const actuator::JointModel& model,
                    const actuator::JointModel& declared);
// The model stays; start states and zeros are fitted.
Fit FitStart(const Recordings& recordings, const actuator::JointModel& model);

}  // namespace sinew::shooting
