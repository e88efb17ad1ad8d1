// Residual of a fit by simulation, as the problem of the search for effects (trace/problem.h):
//
//     measured - simulated = declared b + columns c + noise
//
// declared: how the angle follows the fitted parameters (in counts of their scale), the zeros and
// the start states, with their priors. columns: how it follows every effect of the catalogue at its
// settings, and free curves over position, velocity and drive; each is the difference of two
// simulations with a small coefficient, over that coefficient. Behind the rows of angles, whitened
// by their own colour, stand the gaps between pieces in prior deviations. Pure; allocates.
#pragma once

#include <vector>

#include "components/model/shooting/shooting_fit.h"
#include "components/model/trace/problem.h"

namespace sinew::shooting {

struct Regression {
  trace::Bank bank;          // rows of angles
  Eigen::MatrixXd declared;  // the same with the gaps
  Eigen::MatrixXd columns;
  Eigen::VectorXd target;
  std::vector<Parameter> parameters;      // of the first declared columns
  std::vector<trace::Stretch> stretches;  // rows of each piece
  std::vector<identify::Block> blocks;    // whole pieces, of all rows
  double block_s = 0.0;
  double measured_rms = 0.0, torque_peak = 0.0;  // of the motion about its mean; of the machine
};

// search: with the columns of the effects in force that fit.model lacks, and the curves; null:
// without.
Regression MakeRegression(const Recordings& recordings, const Fit& fit,
                          const std::vector<Parameter>& parameters, const trace::InForce* search);

// Noise of the rows of angles, and how loud the gaps are, in prior deviations.
struct Noise {
  trace::NoiseModel angle;
  double gap = 1.0;
};
// residual: all rows.
Noise NoiseOf(const Regression& regression, const Recordings& recordings,
              const Eigen::Ref<const Eigen::VectorXd>& residual, bool coloured);
Eigen::MatrixXd Whiten(const Regression& regression, const Noise& noise,
                       const Eigen::Ref<const Eigen::MatrixXd>& columns);

trace::Problem MakeProblem(const Regression& regression, const Noise& noise);
// With the noise of what the declared columns and the best effect leave.
trace::Problem ProblemWithNoise(const Regression& regression, const Recordings& recordings,
                                Noise* noise);

// Standard deviations of the fitted parameters, in their own units.
Eigen::VectorXd DeviationOf(const Regression& regression, const Noise& noise);

}  // namespace sinew::shooting
