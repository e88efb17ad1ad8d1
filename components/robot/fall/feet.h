// Loads of the two feet. Each foot has two segments with two force sensors each; order as in
// idl/sensors.idl: right foot 0-3, left foot 4-7. Forces are normal to the sole, positive when
// pressed. Pure functions; noexcept, nothing allocated.
#pragma once

#include <array>

namespace sinew::fall {

inline constexpr int kFootSensors = 8;

struct FootForces {
  std::array<double, kFootSensors> force_N{};
  std::array<bool, kFootSensors> valid{};
};

struct FootLoads {
  double right_N = 0.0, left_N = 0.0;       // sums of the sensors that are valid and finite
  int right_sensors = 0, left_sensors = 0;  // how many of each four

  double total_N() const noexcept { return right_N + left_N; }
  // All eight are there: only then is a small total a foot in the air.
  bool complete() const noexcept { return right_sensors + left_sensors == kFootSensors; }
  // A whole foot is not measured.
  bool lost() const noexcept { return right_sensors == 0 || left_sensors == 0; }
  // The foot whose leg gives the base's height.
  bool right_carries_more() const noexcept { return right_N >= left_N; }
};

FootLoads LoadsOf(const FootForces& forces) noexcept;

}  // namespace sinew::fall
