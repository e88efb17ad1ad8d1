#include "components/robot/residual/moving_states.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::residual {
namespace {

constexpr int kDerivatives = 5;  // 0 to 4, as the polynomial has

bool IsUsable(const JointReading& r) noexcept {
  return r.valid && std::isfinite(r.position_rad) && std::isfinite(r.motor_position_rad) &&
         std::isfinite(r.drive_input) && std::isfinite(r.pressure_bar) &&
         std::isfinite(r.load_force_N) && std::isfinite(r.payload_kg) &&
         std::isfinite(r.temperature_degC);
}

}  // namespace

MovingStates::MovingStates(double period_s, double window_s) : period_s_(period_s), half_(0) {
  if (!(period_s > 0.0) || !(window_s > 0.0) || !(window_s / period_s < 2000.0)) {
    throw std::invalid_argument("window_s = " + std::to_string(window_s) + " at a period of " +
                                std::to_string(period_s) +
                                " s, expected both above 0 and at most 2000 samples");
  }
  half_ = std::max(4, static_cast<int>(std::lround(0.5 * window_s / period_s)));
  const int width = 2 * half_ + 1;
  Eigen::MatrixXd powers(width, kDerivatives);
  for (int i = 0; i < width; ++i) {
    const double x = static_cast<double>(i - half_) / half_;
    for (int k = 0; k < kDerivatives; ++k) powers(i, k) = std::pow(x, k);
  }
  weights_ = powers.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(width, width));
  double factor = 1.0;  // k! / (h dt)^k
  for (int k = 0; k < kDerivatives; ++k) {
    weights_.row(k) *= factor;
    factor *= (k + 1) / (half_ * period_s);
  }
  for (std::vector<double>& channel : ring_) channel.resize(2 * static_cast<std::size_t>(width));
  readings_.resize(static_cast<std::size_t>(width));
}

void MovingStates::Reset() noexcept { good_ = 0; }

double MovingStates::Derivative(Channel channel, int order) const noexcept {
  // next_ is the oldest sample, and the window goes on from there.
  const Eigen::Map<const Eigen::VectorXd> window(ring_[channel].data() + next_, weights_.cols());
  return weights_.row(order).dot(window);
}

bool MovingStates::Push(const JointReading& reading, double time_s,
                        effects::JointSample* state) noexcept {
  const int width = 2 * half_ + 1;
  if (!IsUsable(reading)) {
    good_ = 0;
    return false;
  }
  const auto at = static_cast<std::size_t>(next_);
  const std::array<double, kChannels> values{reading.position_rad, reading.motor_position_rad,
                                             reading.drive_input, reading.pressure_bar};
  for (std::size_t c = 0; c < kChannels; ++c) {
    ring_[c][at] = ring_[c][at + static_cast<std::size_t>(width)] = values[c];
  }
  readings_[at] = reading;
  next_ = (next_ + 1) % width;
  good_ = std::min(good_ + 1, width);
  if (good_ < width) return false;

  const JointReading& middle = readings_[static_cast<std::size_t>((next_ + half_) % width)];
  state->time_s = time_s - delay_s();
  state->position_rad = Derivative(kOutput, 0);
  state->velocity_rad_s = Derivative(kOutput, 1);
  state->acceleration_rad_s2 = Derivative(kOutput, 2);
  state->jerk_rad_s3 = Derivative(kOutput, 3);
  state->snap_rad_s4 = Derivative(kOutput, 4);
  state->motor_position_rad = Derivative(kMotor, 0);
  state->motor_velocity_rad_s = Derivative(kMotor, 1);
  state->motor_acceleration_rad_s2 = Derivative(kMotor, 2);
  state->drive_input = Derivative(kDrive, 0);
  state->drive_rate = Derivative(kDrive, 1);
  state->pressure_bar = Derivative(kPressure, 0);
  state->pressure_rate_bar_s = Derivative(kPressure, 1);
  state->load_force_N = middle.load_force_N;
  state->payload_kg = middle.payload_kg;
  state->temperature_degC = middle.temperature_degC;
  state->valve_open = middle.valve_open;
  return true;
}

}  // namespace sinew::residual
