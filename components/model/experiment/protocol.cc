#include "components/model/experiment/protocol.h"

#include <algorithm>
#include <cmath>

namespace sinew::experiment {
namespace {

constexpr double kMoveSpeed_rad_s = 0.4;
constexpr double kArrived_rad = 0.01;

}  // namespace

void PressureKeeper::Apply(const Reading& reading, Command* command) const noexcept {
  command->valve_open = true;
  command->compressor_on = reading.reservoir_pressure_bar < target_bar - 0.5 * band_bar;
  command->vent_open = reading.reservoir_pressure_bar > target_bar + 0.5 * band_bar;
}

bool PressureKeeper::reached(const Reading& reading) const noexcept {
  return std::abs(reading.chamber_pressure_bar - target_bar) < 2.0 * band_bar;
}

Prepared::Prepared(std::unique_ptr<Protocol> protocol, double gear_ratio)
    : protocol_(std::move(protocol)), gear_ratio_(gear_ratio) {
  keeper_.target_bar = protocol_->start().pressure_bar;
}

double Prepared::expected_s() const {
  return 10.0 + protocol_->start().rest_s + protocol_->expected_s();
}

std::string Prepared::instruction() const {
  if (phase_ == Phase::kRun) return protocol_->instruction();
  const Start start = protocol_->start();
  std::string text = "hands off: the robot goes to its start";
  if (start.motor_uncoupled) text = "uncouple the motor from gearbox and link";
  if (start.rotor_locked) text += "; lock the rotor if you can";
  return text;
}

Command Prepared::Step(const Reading& reading) noexcept {
  const Start start = protocol_->start();
  const double target_rad = start.output_angle_rad + start.motor_offset_rad;
  Command command;
  const double dt_s = std::clamp(reading.time_s - last_s_, 0.0, 0.1);
  last_s_ = reading.time_s;
  if (phase_ == Phase::kFirst) {
    wanted_rad_ = reading.motor_angle_rad / gear_ratio_;
    phase_ = start.motor_uncoupled ? Phase::kRest : Phase::kMove;
    rest_from_s_ = reading.time_s;
  }
  if (phase_ == Phase::kMove) {
    const double step_rad = kMoveSpeed_rad_s * dt_s;
    wanted_rad_ += std::clamp(target_rad - wanted_rad_, -step_rad, step_rad);
    const bool there = std::abs(reading.motor_angle_rad / gear_ratio_ - target_rad) < kArrived_rad;
    if (there && keeper_.reached(reading)) {
      phase_ = Phase::kRest;
      rest_from_s_ = reading.time_s;
    }
  }
  if (phase_ == Phase::kRest && reading.time_s - rest_from_s_ >= start.rest_s) {
    phase_ = Phase::kRun;
    begin_s_ = reading.time_s;
  }
  if (phase_ == Phase::kRun) {
    Reading local = reading;
    local.time_s -= begin_s_;
    return protocol_->Step(local);
  }
  if (!start.motor_uncoupled) {
    command.drive = types::ControlMode::kPosition;
    command.position_rad = wanted_rad_;
    keeper_.Apply(reading, &command);
  }
  return command;
}

double Person::Uniform(double lower, double upper) noexcept {
  state_ += 0x9E3779B97F4A7C15ull;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  z ^= z >> 31;
  return lower + (upper - lower) * (static_cast<double>(z >> 11) * 0x1.0p-53);
}

}  // namespace sinew::experiment
