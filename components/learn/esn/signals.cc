#include "components/learn/esn/signals.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "components/base/types/joined.h"

namespace sinew::esn {
namespace {

constexpr std::array<std::string_view, kSignalCount> kNames = {
    "reference_position_rad", "reference_velocity_rad_s", "reference_acceleration_rad_s2",
    "position_rad",           "velocity_rad_s",           "motor_velocity_rad_s",
    "chamber_pressure_bar",   "play_angle_rad",           "load_force_N",
    "declared_payload_kg",    "motor_temperature_degC",   "reference_direction_1"};

}  // namespace

double ReferenceDirection(double reference_velocity_rad_s) noexcept {
  return std::tanh(reference_velocity_rad_s / kDirectionWidth_rad_s);
}

std::string_view SignalName(Signal signal) { return kNames[static_cast<std::size_t>(signal)]; }

std::optional<Signal> SignalFromName(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<Signal>(i);
  }
  return std::nullopt;
}

std::string_view SignalNames() {
  static const std::string kAll =
      types::Joined(std::vector<std::string>(kNames.begin(), kNames.end()));
  return kAll;
}

void Frame::Clear() noexcept {
  for (auto& joints : value_) joints.fill(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace sinew::esn
