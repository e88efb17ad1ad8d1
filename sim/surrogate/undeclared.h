// Effects of the rig that its declared model lacks, switched on by name.
//
// Each is a mechanism of its own (a table, a bank of slip elements, a mass, a worn part, a sensor's
// fault), written apart from the catalogue that looks for it. `size` has the unit that
// UndeclaredEffects() lists; a second parameter (a place, a shape) is part of the mechanism and
// stands in its table. One owner; no allocation after construction; everything but the constructor
// is noexcept. Sizes of 0 leave every number as it was.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::surrogate {

// In the order of UndeclaredEffects().
enum class Effect {
  kStribeck,
  kDirectionDependentViscous,
  kCogging,
  kSealHysteresis,
  kPayload,
  kQuadraticViscous,
  kDirectionDependentCoulomb,
  kLoadDependentFriction,
  kDriveEfficiencyDirection,
  kTemperatureFriction,
  kTorqueConstantGain,
  kTorqueConstantSaturation,
  kCurrentOffset,
  kGearEccentricity,
  kEncoderEccentricity,
  kBacklashWidth,
  kGearCompliance,
  kFlexibleLink,
  kTransportDelay,
  kLinkInertia,
  kPayloadStep,
  kExternalBump,
  kGravityPhase,
  kLoadCellGain,
  kLoadCellMisalignment,
  kPressureOffset,
  kPressureGain,
  kPressureLag,
  kGasHeatExchange,
  kLeak,
  kValveDeadTime,
  kPresliding,
  kStiffnessCollapse,
  // Outside of the catalogue.
  kCableDrag,
  kBadTooth,
  kSupplySag,
  kSlowTilt,
  kSlippingMagnet,
  kCount,
};

struct EffectInfo {
  std::string_view name;
  std::string_view unit;  // of size
  double default_size;
  double smallest_size;  // 0 where a negative one means nothing
  double largest_size;
  double default_from_s;  // acts from this time on by default
  bool in_catalogue;      // false: no effect of the catalogue describes it
  std::string_view mechanism;
};
std::span<const EffectInfo> UndeclaredEffects();

struct EffectSpec {
  std::string name;
  double size = 0.0;
  double from_s = 0.0;  // acts from this time on
};

// "NAME", "NAME=SIZE", "NAME=SIZE@SECONDS"; "none" gives nothing. Throws std::invalid_argument
// saying what was wrong and which names there are.
std::optional<EffectSpec> ParseEffect(std::string_view text);

// The rig's state at an instant, as far as the effects need it.
struct EffectState {
  double motor_angle_rad = 0.0;       // rotor
  double motor_velocity_rad_s = 0.0;  // rotor
  double output_velocity_rad_s = 0.0;
  double chamber_gauge_bar = 0.0;
  double output_angle_rad = 0.0;
  double motor_temperature_degC = 23.0;
};

class Undeclared {
 public:
  // Throws std::invalid_argument. gear_ratio: rotor turns per output turn.
  Undeclared(const std::vector<EffectSpec>& effects, double gear_ratio);

  void Reset() noexcept;
  void SetTime(double time_s) noexcept;  // switches effects on

  // Present size, 0 while it is off.
  double size(Effect effect) const noexcept { return size_[static_cast<std::size_t>(effect)]; }

  // Added to the sliding friction of the output, N·m; may be negative.
  double ExtraFriction_Nm(const EffectState& state) const noexcept;
  // On the output, positive up.
  double OutputTorque_Nm(const EffectState& state, double dt_s) noexcept;
  // Pressed on the link at the load cell's place beside the cell, N, positive down.
  double Bump_N() const noexcept;
  // On the rotor, positive drives up.
  double RotorTorque_Nm(const EffectState& state) const noexcept;
  double payload_kg() const noexcept { return size(Effect::kPayload) + size(Effect::kPayloadStep); }

  // Air-gap torque over what the declared torque constant makes of the current.
  double TorqueShare(double current_A) const noexcept;
  // Bus voltage over the nominal one.
  double SupplyShare() const noexcept;
  // Tilt of the rig's base, rad; the link's angle to the horizontal is larger by it.
  double Tilt_rad() const noexcept;
  // Share of the chamber's torque that reaches the link.
  double PneumaticShare(double chamber_gauge_bar) const noexcept;

  // The output encoder's magnet turned against the link, rad; moves the slipping magnet.
  void MoveMagnet(double output_velocity_rad_s, double dt_s) noexcept;
  double OutputEncoder_rad(double output_rad) const noexcept;
  double LoadCell_N(double force_N, double output_rad) const noexcept;

 private:
  struct Active {
    EffectSpec spec;
    Effect effect;
    bool on = false;
  };
  std::vector<Active> effects_;
  double gear_ratio_;
  std::array<double, static_cast<std::size_t>(Effect::kCount)> size_{};
  double time_s_ = 0.0;
  double bump_start_s_ = 0.0;
  double magnet_slip_rad_ = 0.0;
  bool magnet_armed_ = true;
  std::vector<double> cogging_table_;
  std::vector<double> wheel_table_;
  std::vector<double> seal_deflection_rad_;
  std::vector<double> bearing_deflection_rad_;
  std::vector<double> cable_deflection_rad_;
};

}  // namespace sinew::surrogate
