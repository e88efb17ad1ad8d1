// Coloured measurement noise as an autoregressive process, and the filter that makes it white.
//
//     e_t = x_t + a_1 x_{t-1} + ... + a_p x_{t-p},   e white with standard deviation sigma
//
// The coefficients come from Burg's method over all stretches of used rows together (Burg 1975:
// Maximum entropy spectral analysis; several segments: Haykin, Kesler 1979), the order from
// Akaike's criterion. The first rows of a stretch use the lower orders of the same recursion,
// scaled to the same innovation, so that the whitened rows have the exact Gaussian likelihood of
// the process and no row is lost. A share of white noise (kWhiteFloor of the variance) is added to
// the recursion's denominators: a band that holds no noise at all, as in interpolated recordings,
// is not amplified without bound. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sinew::trace {

// Rows first .. first + count - 1 follow each other in time, one sampling period apart.
struct Stretch {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

class NoiseModel {
 public:
  // White noise of standard deviation 1: whitening changes nothing.
  NoiseModel() = default;
  // noise: a value per row of the stretches. longest_order >= 0.
  NoiseModel(const Eigen::Ref<const Eigen::VectorXd>& noise, const std::vector<Stretch>& stretches,
             int longest_order);

  int order() const { return static_cast<int>(coefficients_.cols()); }
  double sigma() const { return sigma_; }

  // Every column, times the rows' weights where there are any, whitened and divided by sigma,
  // stretch by stretch.
  Eigen::MatrixXd Whiten(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                         const std::vector<Stretch>& stretches,
                         const Eigen::VectorXd& weight = {}) const;
  // The transposed filter: Transpose(e) . x = e . Whiten(x), for scans over many columns.
  Eigen::VectorXd Transpose(const Eigen::Ref<const Eigen::VectorXd>& whitened,
                            const std::vector<Stretch>& stretches) const;

 private:
  Eigen::MatrixXd coefficients_;  // row m: a_1 .. a_m of order m, m = 0 .. order
  Eigen::VectorXd scale_ = Eigen::VectorXd::Ones(1);  // 1 / innovation of order m
  double sigma_ = 1.0;
};

}  // namespace sinew::trace
