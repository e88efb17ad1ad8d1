// The linear model, and the linear dynamic block of the Wiener models.
//
//     x(t) = G(u(t)) = sum_n g_n u(t - n)          (4.43), (4.45)
//     y(t) = f(x(t))                               (4.44)
//
// The source counts 3 parameters = inputs: one coefficient each, N = 0 (the dynamics are in the
// inputs, acceleration and velocity). So taps = 1 is the published block, more taps are possible.
// No constant: inputs and targets are normalised. f sees x and, as the source counts 7 inputs, the
// six others too. Fitted by ridge regression on the training samples.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "reproduction/networks/samples.h"

namespace sinew::networks {

struct LinearModel {
  std::vector<int> inputs;  // rows of the samples
  int taps = 1;
  Eigen::VectorXd coefficients;  // inputs x taps: g_0 of all inputs, g_1, ...

  int parameter_count() const { return static_cast<int>(coefficients.size()); }
  // 1 x T; before a sequence begins, its first sample.
  Eigen::VectorXd Predict(const Samples& samples) const;
};

// beta >= 0. Throws std::invalid_argument: no inputs, taps below 1, several targets.
LinearModel FitLinear(const Samples& samples, const std::vector<int>& inputs, int taps = 1,
                      double beta = 0.01);

}  // namespace sinew::networks
