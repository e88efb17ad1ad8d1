// Adam (Kingma and Ba 2015, algorithm 1).
//
//     m = b1 m + (1 - b1) g;  v = b2 v + (1 - b2) g^2
//     w -= rate m / (1 - b1^t) / (sqrt(v / (1 - b2^t)) + eps)
//
// One owner. Memory is taken in the constructor only.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

namespace sinew::networks {

struct AdamConfig {
  double rate = 0.001;  // > 0
  double b1 = 0.9;
  double b2 = 0.999;
  double epsilon = 1e-7;
};

template <typename S>
class Adam {
 public:
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

  // Throws std::invalid_argument for a rate that is not positive or b1, b2 outside [0, 1).
  Adam(const AdamConfig& config, Eigen::Index parameters)
      : config_(config), m_(Vector::Zero(parameters)), v_(Vector::Zero(parameters)) {
    if (!(config.rate > 0.0) || !(config.b1 >= 0.0 && config.b1 < 1.0) ||
        !(config.b2 >= 0.0 && config.b2 < 1.0) || !(config.epsilon > 0.0)) {
      throw std::invalid_argument(
          "adam: expected rate and epsilon above 0, b1 and b2 from 0 to below 1");
    }
  }

  void Step(const Vector& gradient, Vector* parameters) noexcept {
    b1_power_ *= config_.b1;
    b2_power_ *= config_.b2;
    const S b1 = static_cast<S>(config_.b1);
    const S b2 = static_cast<S>(config_.b2);
    m_ = b1 * m_ + (S{1} - b1) * gradient;
    v_.array() = b2 * v_.array() + (S{1} - b2) * gradient.array().square();
    const S rate = static_cast<S>(config_.rate / (1.0 - b1_power_));
    const S correction = static_cast<S>(1.0 / std::sqrt(1.0 - b2_power_));
    parameters->array() -=
        rate * m_.array() / (correction * v_.array().sqrt() + static_cast<S>(config_.epsilon));
  }

 private:
  AdamConfig config_;
  Vector m_;
  Vector v_;
  double b1_power_ = 1.0;
  double b2_power_ = 1.0;
};

}  // namespace sinew::networks
