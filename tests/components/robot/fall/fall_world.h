// A biped as the fall detector sees it: an inverted pendulum that leans in one vertical plane, its
// sensors with noise and bias, its feet.
//
// Lean by theta towards d = (cos phi, sin phi, 0): rotation about k = z x d. The pivot (the foot)
// may accelerate, and so may the base along the leg; the IMU sits at r above the foot. Specific
// force in the body's frame, with horizontal = cos theta d + sin theta z and vertical = -sin theta
// d + cos theta z:
//
//     f = r theta'' d - r theta'^2 z + a_h horizontal + (a_v + g) vertical
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "components/robot/fall/fall_detector.h"

namespace sinew::fall {

inline constexpr double kStanding_m = 0.65;
inline constexpr double kMass_kg = 17.1;

struct BodyState {
  double lean_rad = 0.0, lean_rad_s = 0.0, lean_rad_s2 = 0.0;
  double direction_rad = 0.0;    // phi
  double imu_height_m = 0.7;     // r
  double horizontal_m_s2 = 0.0;  // a_h
  double vertical_m_s2 = 0.0;    // a_v
  double leg_m = kStanding_m;    // from the foot to the base
  bool leg_vertical = false;     // the leg stays upright while the torso leans (squat)
  double reference_m = kStanding_m;
  double load_share = 1.0;  // of the weight that the feet carry
  double right_share = 0.5, toe_share = 0.5;

  Eigen::Vector3d toward() const { return {std::cos(direction_rad), std::sin(direction_rad), 0.0}; }
  Eigen::Vector3d up() const {
    return std::cos(lean_rad) * Eigen::Vector3d::UnitZ() - std::sin(lean_rad) * toward();
  }
  double base_height_m() const { return leg_vertical ? leg_m : leg_m * std::cos(lean_rad); }
  // The truth that the detector is held to.
  bool fallen() const {
    return std::abs(lean_rad) > 30.0 * types::kDegree_rad || base_height_m() < 0.8 * reference_m;
  }
};

// Sensors within the bounds that the detector is given: biases and scale are drawn once.
class SensorModel {
 public:
  explicit SensorModel(std::uint64_t seed, const ImuBounds& bounds = {})
      : bounds_(bounds), random_(seed) {
    const double axis_m_s2 = bounds.force_bias_m_s2 / std::sqrt(2.0);
    force_bias_ = {Uniform(axis_m_s2), Uniform(axis_m_s2), Uniform(0.08 * types::kGravity_m_s2)};
    const double axis_rad_s = bounds.rate_bias_rad_s / std::sqrt(3.0);
    rate_bias_ = {Uniform(axis_rad_s), Uniform(axis_rad_s), Uniform(axis_rad_s)};
    const double drift_rad_s2 = bounds.rate_drift_rad_s2 / std::sqrt(3.0);
    drift_ = {Uniform(drift_rad_s2), Uniform(drift_rad_s2), Uniform(drift_rad_s2)};
    scale_ = 1.0 + Uniform(bounds.rate_scale_error);
  }

  double Uniform(double half_width) {
    return std::uniform_real_distribution<double>(-half_width, half_width)(random_);
  }
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  FallInput Read(std::uint64_t tick, double time_s, const BodyState& body,
                 const Eigen::Vector3d& shock_m_s2 = Eigen::Vector3d::Zero()) {
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), d = body.toward();
    const Eigen::Vector3d horizontal = std::cos(body.lean_rad) * d + std::sin(body.lean_rad) * z;
    const Eigen::Vector3d force = body.imu_height_m * body.lean_rad_s2 * d -
                                  body.imu_height_m * body.lean_rad_s * body.lean_rad_s * z +
                                  body.horizontal_m_s2 * horizontal +
                                  (body.vertical_m_s2 + types::kGravity_m_s2) * body.up();
    const Eigen::Vector3d rate = body.lean_rad_s * z.cross(d);
    FallInput input;
    input.tick = tick;
    input.imu.valid = true;
    for (int i = 0; i < 3; ++i) {
      input.imu.force_m_s2[i] =
          Converted(force[i] + shock_m_s2[i] + force_bias_[i] + Noise(bounds_.force_noise_m_s2),
                    bounds_.force_range_m_s2);
      input.imu.rate_rad_s[i] = Converted(
          scale_ * rate[i] + rate_bias_[i] + drift_[i] * time_s + Noise(bounds_.rate_noise_rad_s),
          bounds_.rate_range_rad_s);
    }
    const double weight_N = body.load_share * kMass_kg * types::kGravity_m_s2;
    for (std::size_t i = 0; i < input.feet.force_N.size(); ++i) {
      const double foot = i < 4 ? body.right_share : 1.0 - body.right_share;
      const double segment = i % 4 < 2 ? body.toe_share : 1.0 - body.toe_share;
      input.feet.force_N[i] = 0.5 * weight_N * foot * segment + Noise(0.5);
      input.feet.valid[i] = true;
    }
    const Eigen::Vector3d leg = body.leg_vertical ? body.up() : z;
    input.foot_to_base_m = (body.leg_m + Uniform(0.0025)) * leg;
    input.reference_height_m = body.reference_m;
    return input;
  }

 private:
  double Noise(double deviation) { return deviation * std::normal_distribution<double>()(random_); }
  // 16 bits over the range, clipped.
  static double Converted(double value, double range) {
    const double step = range / 32768.0;
    return std::clamp(std::round(value / step), -32768.0, 32767.0) * step;
  }

  ImuBounds bounds_;
  std::mt19937_64 random_;
  Eigen::Vector3d force_bias_, rate_bias_, drift_;
  double scale_;
};

}  // namespace sinew::fall
