// The statistics that intervals and decisions need. Pure, any thread; nothing throws.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace sinew::identify {

// The t below which a share p in (0, 1) of Student's t with `freedom` > 0 degrees of freedom lies;
// not a number for other arguments.
double StudentQuantile(double p, double freedom);

// Root mean square; 0 for none.
double Rms(const Eigen::Ref<const Eigen::VectorXd>& values);
double Mean(const std::vector<double>& values);
// Standard deviation with n - 1; 0 for fewer than 2 values.
double StandardDeviation(const std::vector<double>& values);
// Standard deviation of Gaussian values around 0, from the median of their sizes; 0 for none.
double RobustDeviation(std::vector<double> values);
// The value below which a share p of the values lies (linear between order statistics).
double Quantile(std::vector<double> values, double p);

// The step that nearly all differences of a signal are whole multiples of; 0 for none.
double Resolution(const Eigen::VectorXd& x);

// Standard deviation of white noise on signals, from the median absolute value of their fourth
// differences (70 times its variance): smooth motion and spikes are not seen.
double WhiteNoise(std::span<const Eigen::VectorXd> signals);

}  // namespace sinew::identify
