// The declared physics as a regression, so that the networks have something to beat.
//
//   sea, (5.4) with the play:  F l = K P + T_dyn s(w) - T_gravity + k P theta + d w
//   pea, (4.12) for the motor torque:  T_m = J dw + B w + T_c s(w) + G cos q - K P + F l c + T_0
//   force:  F = A P + F_c s(v) + F_p P s(v) + d v + F_0
//
// s(w) = tanh(w / w0). All are linear in their coefficients, which are fitted by least squares to
// the training samples in physical units: 6, 7 and 5 parameters.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "reproduction/networks/dataset/dataset.h"
#include "reproduction/networks/samples.h"

namespace sinew::networks {

struct GreyBox {
  std::vector<std::string> names;  // of the coefficients, with units
  Eigen::VectorXd coefficients;
  int parameter_count() const { return static_cast<int>(coefficients.size()); }
};

// predicted: normalised, 1 x T.
GreyBox FitGreyBox(Task task, const Samples& samples, Eigen::MatrixXd* predicted);

}  // namespace sinew::networks
