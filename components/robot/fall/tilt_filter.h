// Tilt of the torso: the direction of "up" in the IMU's frame, by a complementary filter on the
// sphere, with an error bound derived from the IMU's stated bounds.
//
// Mahony, Hamel, Pflimlin, IEEE Trans. Automatic Control 53 (2008) 1203, explicit filter (eq. 32),
// reduced to the one direction that is measured (heading is not observable and not needed). With u
// the estimate of up, v = f / |f| the measured one, w the angular velocity, b its bias:
//
//     u' = -(w - b + kP e) x u,    b' = -kI e,    e = v x u
//     kP = d g / l,  kI = kP^2 / 4    delay d = 15 ms in the fall of a pendulum of l = 1 m
//
// Specific forces that are not near g (||f| - g| > gate) are not used: gate = bias + motion + four
// standard deviations of the noise. Without them the rotation alone is integrated. Start: the torso
// must hold still for start_s, in any attitude. Derivation of gains, error bound and start:
// README.md.
//
// Frames, signs: imu_check.h. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <Eigen/Core>

#include "components/robot/fall/imu_check.h"

namespace sinew::fall {

struct TiltConfig {
  ImuBounds imu;
  double limit_rad = 30.0 * types::kDegree_rad;  // the tilt that matters
  double pendulum_length_m = 1.0;  // l: foot to highest mass; a shorter one falls faster
  double filter_delay_s = 0.015;   // d
  double start_s = 2.0;
  double start_sway_rad = 0.2 * types::kDegree_rad;
  // Accelerations of the torso in healthy motion. The benchmark squat (0.2 m amplitude, 0.2 Hz) has
  // 0.32 m/s2 vertically; three times that for tracking errors, also sideways.
  double motion_m_s2 = 1.0;
  double motion_rad_s = 1.2566;  // 0.2 Hz, the slowest of them: slower ones are filtered less
  double coast_error_rad = 0.5 * types::kDegree_rad;
};

class TiltFilter {
 public:
  // Throws std::invalid_argument: a figure that is not positive, bounds of the IMU out of range.
  TiltFilter(const TiltConfig& config, double period_s);

  void Reset() noexcept;  // begins the start

  // elapsed_s: since the last Step, positive. A sample that may not be used by `use` leaves the
  // last angular velocity in force for that time.
  void Step(const ImuSample& sample, const ImuUse& use, double elapsed_s) noexcept;

  bool started() const noexcept { return started_; }
  // Unit vector, IMU frame. (0, 0, 1) before the start has ended.
  const Eigen::Vector3d& up() const noexcept { return up_; }
  // Angle between z of the IMU and up, 0 to pi.
  double tilt_rad() const noexcept;
  const Eigen::Vector3d& rate_bias_rad_s() const noexcept { return bias_rad_s_; }

  double error_bound_rad() const noexcept { return error_bound_rad_; }
  double gain_1_s() const noexcept { return gain_1_s_; }
  double gate_m_s2() const noexcept { return gate_m_s2_; }
  // Time without a usable specific force.
  double coasting_s() const noexcept { return coasting_s_; }
  // After so long the integrated error of the bias passes coast_error: error of the start's bias
  // plus the filter's own lag behind the drift, 4 drift / kP.
  double coast_s() const noexcept { return coast_s_; }

 private:
  void StepStart(const ImuSample& sample, const ImuUse& use, double elapsed_s) noexcept;
  void BeginStart() noexcept;

  TiltConfig config_;
  double gain_1_s_, integral_gain_1_s2_, gate_m_s2_, error_bound_rad_, coast_s_;
  double half_s_;            // shortest half of the start: a whole number of periods
  int half_count_;           // fewest samples of a half
  double start_span_rad_s_;  // largest of an axis
  double start_rate_rad_s_;  // largest at rest
  bool started_ = false;
  struct Half {
    double elapsed_s = 0.0;
    int count = 0;
    Eigen::Vector3d force_sum_m_s2 = Eigen::Vector3d::Zero();
  };
  Half first_half_, second_half_;
  Eigen::Vector3d rate_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_low_ = Eigen::Vector3d::Zero(), rate_high_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d bias_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_rad_s_ = Eigen::Vector3d::Zero();  // last usable one
  double coasting_s_ = 0.0;
};

}  // namespace sinew::fall
