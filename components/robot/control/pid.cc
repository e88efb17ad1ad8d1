#include "components/robot/control/pid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sinew::control {
namespace {

void RequireNotNegative(double value, const char* what) {
  if (!(value >= 0.0) || !std::isfinite(value)) {
    throw std::invalid_argument(std::string(what) + " is " + std::to_string(value) +
                                ", expected a finite number of at least 0");
  }
}

}  // namespace

Pid::Pid(const PidConfig& config) : config_(config) {
  RequireNotNegative(config.proportional_Nm_rad, "proportional gain");
  RequireNotNegative(config.integral_Nm_rad_s, "integral gain");
  RequireNotNegative(config.derivative_Nm_s_rad, "derivative gain");
  RequireNotNegative(config.derivative_filter_Hz, "derivative filter");
  RequireNotNegative(config.integral_limit_Nm, "integral limit");
  RequireNotNegative(config.anti_windup_s, "anti-windup time");
  if (config.anti_windup_s == 0.0) throw std::invalid_argument("anti-windup time is 0");
}

void Pid::Reset() noexcept {
  integral_Nm_ = derivative_Nm_ = output_Nm_ = 0.0;
  derivative_known_ = false;
}

double Pid::Step(double error_rad, double error_rate_rad_s, double period_s) noexcept {
  integral_Nm_ += config_.integral_Nm_rad_s * error_rad * period_s;
  if (config_.integral_limit_Nm > 0.0) {
    integral_Nm_ = std::clamp(integral_Nm_, -config_.integral_limit_Nm, config_.integral_limit_Nm);
  }
  const double raw_Nm = config_.derivative_Nm_s_rad * error_rate_rad_s;
  if (config_.derivative_filter_Hz > 0.0 && derivative_known_) {
    const double lag_s = 1.0 / (2.0 * std::numbers::pi * config_.derivative_filter_Hz);
    derivative_Nm_ += period_s / (period_s + lag_s) * (raw_Nm - derivative_Nm_);
  } else {
    derivative_Nm_ = raw_Nm;
    derivative_known_ = true;
  }
  output_Nm_ = config_.proportional_Nm_rad * error_rad + integral_Nm_ + derivative_Nm_;
  return output_Nm_;
}

void Pid::Limited(double excess_Nm, double period_s) noexcept {
  if (config_.integral_Nm_rad_s == 0.0) return;
  integral_Nm_ += std::min(1.0, period_s / config_.anti_windup_s) * excess_Nm;
}

void Pid::Shift(double torque_Nm) noexcept {
  integral_Nm_ += torque_Nm;
  if (config_.integral_limit_Nm > 0.0) {
    integral_Nm_ = std::clamp(integral_Nm_, -config_.integral_limit_Nm, config_.integral_limit_Nm);
  }
}

}  // namespace sinew::control
