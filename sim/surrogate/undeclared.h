// What the rig does and its declared model does not say: effects switched on by name.
//
// Each is a mechanism of its own (a table, a bank of slip elements, a mass), written apart from the
// catalogue that looks for it. `size` has the unit that UndeclaredEffects() tells; the default
// sizes leave about 30 % of the moving residual's variance after the declared model was refitted
// (README.md says how that was measured). One owner; no allocation after construction; the torques
// are noexcept.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::surrogate {

struct EffectInfo {
  std::string_view name;
  std::string_view unit;  // of size
  double default_size;
  double largest_size;  // in magnitude
  std::string_view mechanism;
};
const std::vector<EffectInfo>& UndeclaredEffects();

struct EffectSpec {
  std::string name;
  double size = 0.0;
  double from_s = 0.0;  // acts from this time on
};

// "NAME", "NAME=SIZE", "NAME=SIZE@SECONDS"; "none" gives nothing. Throws std::invalid_argument
// saying what was wrong and which names there are.
std::optional<EffectSpec> ParseEffect(std::string_view text);

// What the effects need to know at an instant.
struct EffectState {
  double motor_angle_rad = 0.0;       // rotor
  double motor_velocity_rad_s = 0.0;  // rotor
  double output_velocity_rad_s = 0.0;
  double chamber_gauge_bar = 0.0;
};

class Undeclared {
 public:
  // Throws std::invalid_argument. gear_ratio: rotor turns per output turn.
  Undeclared(const std::vector<EffectSpec>& effects, double gear_ratio);

  void Reset() noexcept;
  void SetTime(double time_s) noexcept;  // switches effects on

  // Added to the sliding friction of the output, N·m, >= 0.
  double ExtraFriction_Nm(double output_velocity_rad_s) const noexcept;
  // On the output, positive up.
  double OutputTorque_Nm(const EffectState& state, double dt_s) noexcept;
  // On the rotor, positive drives up.
  double RotorTorque_Nm(const EffectState& state) const noexcept;
  double payload_kg() const noexcept { return payload_kg_; }

 private:
  struct Active {
    EffectSpec spec;
    bool on = false;
  };
  std::vector<Active> effects_;
  double gear_ratio_;
  double stribeck_Nm_ = 0.0;
  double direction_Nm_s_rad_ = 0.0;
  double cogging_Nm_ = 0.0;
  double seal_Nm_bar_ = 0.0;
  double payload_kg_ = 0.0;
  double quadratic_Nm_ = 0.0;
  std::vector<double> cogging_table_;
  std::vector<double> seal_deflection_rad_;
};

}  // namespace sinew::surrogate
