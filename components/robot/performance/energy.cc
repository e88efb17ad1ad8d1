#include "components/robot/performance/energy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "components/robot/performance/sliding_window.h"

namespace sinew::performance {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// int max(p, 0) dt of the line from a to b.
double PositivePart(double a_W, double b_W, double duration_s) noexcept {
  if (a_W >= 0.0 && b_W >= 0.0) return 0.5 * (a_W + b_W) * duration_s;
  if (a_W <= 0.0 && b_W <= 0.0) return 0.0;
  const double above = std::max(a_W, b_W);
  return 0.5 * above * (above / (above - std::min(a_W, b_W))) * duration_s;
}

}  // namespace

PowerIntegral::PowerIntegral(double period_s, double bridge_s)
    : period_s_(period_s),
      bridge_ticks_(static_cast<std::uint64_t>(std::max(1, TicksOf(bridge_s, period_s)))) {}

void PowerIntegral::Step(std::uint64_t tick, double power_W) noexcept {
  if (started_ && tick <= last_tick_) return;
  if (!started_) sample_tick_ = tick;
  started_ = true;
  last_tick_ = tick;
  const std::uint64_t ticks = tick - sample_tick_;
  if (!IsUsable(power_W)) {
    coverage_.pending = ticks;
    return;
  }
  coverage_.pending = 0;
  if (has_sample_ && ticks <= bridge_ticks_) {
    const double duration_s = static_cast<double>(ticks) * period_s_;
    positive_.Add(PositivePart(sample_W_, power_W, duration_s));
    net_.Add((0.5 * sample_W_ + 0.5 * power_W) * duration_s);
    (ticks == 1 ? coverage_.integrated : coverage_.bridged) += ticks;
  } else {
    coverage_.omitted += ticks;
  }
  has_sample_ = true;
  sample_tick_ = tick;
  sample_W_ = power_W;
}

JointEnergy::JointEnergy(const MotorConstants& motor, double period_s, double bridge_s)
    : motor_(motor),
      mechanical_(period_s, bridge_s),
      copper_(period_s, bridge_s),
      electrical_(period_s, bridge_s),
      electrical_W_(kNotMeasured) {
  const auto refuse = [](const char* what, double value) {
    throw std::invalid_argument(std::string(what) + ", got " + std::to_string(value));
  };
  const double resistance_Ohm = motor.copper_resistance_Ohm;
  if (!std::isfinite(resistance_Ohm) || resistance_Ohm < 0.0) {
    refuse("copper_resistance_Ohm is not negative", resistance_Ohm);
  }
  const double constant_Nm_A = motor.torque_constant_Nm_A;
  if (!std::isfinite(constant_Nm_A) || constant_Nm_A < 0.0 ||
      (resistance_Ohm > 0.0 && constant_Nm_A == 0.0)) {
    refuse("torque_constant_Nm_A is not negative, and positive with a resistance", constant_Nm_A);
  }
  if (!std::isfinite(motor.gear_ratio) || motor.gear_ratio == 0.0) {
    refuse("gear_ratio is not zero", motor.gear_ratio);
  }
}

void JointEnergy::Step(std::uint64_t tick, double torque_Nm, double velocity_rad_s,
                       double current_A) noexcept {
  mechanical_.Step(tick, torque_Nm * velocity_rad_s);
  electrical_W_ = kNotMeasured;
  if (motor_.copper_resistance_Ohm == 0.0) return;
  const double copper_W = motor_.copper_resistance_Ohm * current_A * current_A;
  electrical_W_ =
      copper_W + motor_.torque_constant_Nm_A * current_A * motor_.gear_ratio * velocity_rad_s;
  copper_.Step(tick, copper_W);
  electrical_.Step(tick, electrical_W_);
}

Energies JointEnergy::energies() const noexcept {
  Energies energies;
  energies.absolute_J = mechanical_.absolute_J();
  energies.positive_J = mechanical_.positive_J();
  energies.net_J = mechanical_.net_J();
  energies.electrical_known = motor_.copper_resistance_Ohm > 0.0;
  energies.copper_loss_J = copper_.net_J();
  energies.electrical_net_J = electrical_.net_J();
  energies.electrical_drawn_J = electrical_.positive_J();
  return energies;
}

}  // namespace sinew::performance
