// Torque that repeats with an angle, at any order: a continuous spectrum over the orders.
//
//     P(n) = |sum_i g_i exp(j n a_i)|^2,   g = A' e
//
// a: the angle of each row as it was measured, e: the whitened residual, A: the whitening filter,
// so that the sum is the exact inner product of the whitened residual with a whitened sine or
// cosine. Angle and torque of a row belong to the same instant, so a line far above the Nyquist
// frequency is still a plain regressor of the angle. Orders lie on a grid of a quarter of the
// resolution, one over the turns that were covered. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sinew::trace {

struct OrderLine {
  double order = 0.0;  // periods per turn of the angle
  double power = 0.0;  // |sum|^2: strongest of the grid
};

// The strongest order between the lowest that the covered range shows (one period in it) and
// `highest`, those within the resolution of `known` left out: where a line was fitted its skirts
// remain. angle in radians, per row.
OrderLine StrongestOrder(const Eigen::Ref<const Eigen::VectorXd>& g,
                         const Eigen::Ref<const Eigen::VectorXd>& angle, double lowest,
                         double highest, const std::vector<double>& known = {});

// The same where the rows that pass an order faster than `band` (periods per second times 2 pi) do
// not show it: every octave of orders is looked for in the rows that are slow enough for it, and
// the power is a share of what chance gives them. speed: of the angle, rad/s, not negative.
OrderLine StrongestRipple(const Eigen::Ref<const Eigen::VectorXd>& g,
                          const Eigen::Ref<const Eigen::VectorXd>& angle,
                          const Eigen::Ref<const Eigen::VectorXd>& speed, double band,
                          double lowest, double highest, const std::vector<double>& known = {});

// Turns that the angle covered, max - min.
double TurnsCovered(const Eigen::Ref<const Eigen::VectorXd>& angle);

// Number of independent orders between two: what a search over them is charged for.
double IndependentOrders(double turns, double lowest, double highest);

}  // namespace sinew::trace
