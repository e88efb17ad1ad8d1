#include "components/robot/fall/tilt_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sinew::fall {
namespace {

constexpr double kStartSigmas = 5.0;  // README.md, start
constexpr double kSigmas = 4.0;       // of white noise: 6e-5 of the samples of an axis are beyond

void RequirePositive(double value, const char* name) {
  if (!std::isfinite(value) || value <= 0.0) {
    throw std::invalid_argument(std::string(name) + " is positive, got " + std::to_string(value));
  }
}

double ErrorBound_rad(const TiltConfig& config, double gain, double integral_gain,
                      double period_s) {
  const ImuBounds& imu = config.imu;
  const std::complex<double> s(0.0, config.motion_rad_s);
  const double motion = std::abs((gain * s + integral_gain) / std::pow(s + gain / 2.0, 2));
  const double rate_variance = imu.rate_noise_rad_s * imu.rate_noise_rad_s / (2.0 * gain);
  const double force_noise = imu.force_noise_m_s2 / types::kGravity_m_s2;
  const double force_variance = force_noise * force_noise * 5.0 * gain / 8.0;
  return imu.force_bias_m_s2 / types::kGravity_m_s2 +
         config.motion_m_s2 / types::kGravity_m_s2 * motion +
         imu.rate_drift_rad_s2 / integral_gain +
         2.0 / (std::numbers::e * gain) * config.start_sway_rad / config.start_s +
         config.start_sway_rad + imu.rate_scale_error * config.limit_rad +
         kSigmas * std::sqrt((rate_variance + force_variance) * period_s) + config.coast_error_rad;
}

// A direction that stands still in the world, after the frame has turned by `turn` (rad, in it).
Eigen::Vector3d SeenAfterTurn(const Eigen::Vector3d& direction, const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0.0) return direction;
  const Eigen::Vector3d axis = turn / angle;
  const Eigen::Vector3d turned = std::cos(angle) * direction -
                                 std::sin(angle) * axis.cross(direction) +
                                 (1.0 - std::cos(angle)) * axis.dot(direction) * axis;
  return turned.normalized();
}

}  // namespace

TiltFilter::TiltFilter(const TiltConfig& config, double period_s) : config_(config) {
  ImuCheck{config.imu};  // throws for bounds out of range
  RequirePositive(period_s, "period_s");
  RequirePositive(config.limit_rad, "limit_rad");
  RequirePositive(config.pendulum_length_m, "pendulum_length_m");
  RequirePositive(config.filter_delay_s, "filter_delay_s");
  RequirePositive(config.start_s, "start_s");
  RequirePositive(config.start_sway_rad, "start_sway_rad");
  RequirePositive(config.motion_m_s2, "motion_m_s2");
  RequirePositive(config.motion_rad_s, "motion_rad_s");
  RequirePositive(config.coast_error_rad, "coast_error_rad");
  const ImuBounds& imu = config.imu;
  gain_1_s_ = config.filter_delay_s * types::kGravity_m_s2 / config.pendulum_length_m;
  integral_gain_1_s2_ = gain_1_s_ * gain_1_s_ / 4.0;
  gate_m_s2_ = imu.force_bias_m_s2 + config.motion_m_s2 + kSigmas * imu.force_noise_m_s2;
  error_bound_rad_ = ErrorBound_rad(config, gain_1_s_, integral_gain_1_s2_, period_s);
  coast_s_ = config.coast_error_rad /
             (config.start_sway_rad / config.start_s + 4.0 * imu.rate_drift_rad_s2 / gain_1_s_);
  // Half a period less than that whole number, against rounding of the sum.
  half_s_ = (std::max(1.0, std::ceil(0.5 * config.start_s / period_s)) - 0.5) * period_s;
  const double noise_of_sway =
      kSigmas * imu.rate_noise_rad_s * config.start_s / config.start_sway_rad;
  half_count_ = std::max(1, static_cast<int>(std::ceil(noise_of_sway * noise_of_sway)));
  start_span_rad_s_ = 2.0 * (kStartSigmas * imu.rate_noise_rad_s +
                             std::numbers::pi * config.start_sway_rad / config.start_s);
  start_rate_rad_s_ = imu.rate_bias_rad_s + kSigmas * std::sqrt(3.0) * imu.rate_noise_rad_s +
                      config.start_sway_rad / config.start_s;
}

void TiltFilter::Reset() noexcept {
  started_ = false;
  up_ = Eigen::Vector3d::UnitZ();
  bias_rad_s_.setZero();
  coasting_s_ = 0.0;
  BeginStart();
}

void TiltFilter::BeginStart() noexcept {
  first_half_ = {};
  second_half_ = {};
  rate_sum_.setZero();
}

double TiltFilter::tilt_rad() const noexcept { return std::atan2(up_.head<2>().norm(), up_.z()); }

void TiltFilter::StepStart(const ImuSample& sample, const ImuUse& use, double elapsed_s) noexcept {
  const auto over = [this](const Half& half) {
    return half.elapsed_s >= half_s_ && half.count >= half_count_;
  };
  Half& half = over(first_half_) ? second_half_ : first_half_;
  // A sensor that is read faster than it measures repeats itself; what is lost for long is the
  // caller's to see (fall_detector.h).
  if (first_half_.count > 0 || use.rate_usable) half.elapsed_s += elapsed_s;
  if (!use.rate_usable) return;
  const bool still = use.force_usable && sample.rate_rad_s.norm() <= start_rate_rad_s_ &&
                     std::abs(sample.force_m_s2.norm() - types::kGravity_m_s2) <= gate_m_s2_;
  if (first_half_.count == 0) rate_low_ = rate_high_ = sample.rate_rad_s;
  rate_low_ = rate_low_.cwiseMin(sample.rate_rad_s);
  rate_high_ = rate_high_.cwiseMax(sample.rate_rad_s);
  if (!still || (rate_high_ - rate_low_).maxCoeff() > start_span_rad_s_) {
    BeginStart();
    return;
  }
  half.force_sum_m_s2 += sample.force_m_s2;
  rate_sum_ += sample.rate_rad_s;
  ++half.count;
  if (!over(first_half_) || !over(second_half_)) return;
  const Eigen::Vector3d first_m_s2 = first_half_.force_sum_m_s2 / first_half_.count;
  const Eigen::Vector3d second_m_s2 = second_half_.force_sum_m_s2 / second_half_.count;
  const double turned_rad =
      std::atan2(first_m_s2.cross(second_m_s2).norm(), first_m_s2.dot(second_m_s2));
  // Two means of so many samples, two horizontal axes.
  const double noise_rad = config_.imu.force_noise_m_s2 / types::kGravity_m_s2 *
                           std::sqrt(2.0 / first_half_.count + 2.0 / second_half_.count);
  if (turned_rad > config_.start_sway_rad + kSigmas * noise_rad) {
    BeginStart();
    return;
  }
  up_ = (first_m_s2 + second_m_s2).normalized();
  bias_rad_s_ = rate_sum_ / (first_half_.count + second_half_.count);
  rate_rad_s_ = sample.rate_rad_s;
  coasting_s_ = 0.0;
  started_ = true;
}

void TiltFilter::Step(const ImuSample& sample, const ImuUse& use, double elapsed_s) noexcept {
  if (!started_) {
    StepStart(sample, use, elapsed_s);
    return;
  }
  const Eigen::Vector3d last_rad_s = rate_rad_s_;
  if (use.rate_usable) rate_rad_s_ = sample.rate_rad_s;
  Eigen::Vector3d rate_rad_s = 0.5 * (last_rad_s + rate_rad_s_) - bias_rad_s_;
  const double norm_m_s2 = use.force_usable ? sample.force_m_s2.norm() : 0.0;
  coasting_s_ += elapsed_s;
  if (use.force_usable && std::abs(norm_m_s2 - types::kGravity_m_s2) <= gate_m_s2_) {
    const Eigen::Vector3d error = (sample.force_m_s2 / norm_m_s2).cross(up_);
    rate_rad_s += gain_1_s_ * error;
    bias_rad_s_ -= integral_gain_1_s2_ * elapsed_s * error;
    coasting_s_ = 0.0;
  }
  up_ = SeenAfterTurn(up_, rate_rad_s * elapsed_s);
}

}  // namespace sinew::fall
