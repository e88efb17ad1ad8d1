// Chamber, reservoir and relays of one pneumatic element as isothermal gas.
//
//     n = p V                        amount of gas in bar m^3, p absolute
//     dn_chamber/dt   =  C_valve (p_reservoir - p_chamber) [valve open] - C_leak (p_chamber - p_0)
//     dn_reservoir/dt = -C_valve (p_reservoir - p_chamber) [valve open] + Q_compressor [compressor
//     on,
//                       below its cut-out] - C_vent (p_reservoir - p_0) [vent open]
//     V_chamber(q) = V_0 + 1e-5 (K (q - q0) - k1 (q - q0)^2 / 2)
//
// The volume follows from the torque K P - k1 P (q - q0): the work of the gas is P dV (1e5 Pa = 1
// bar). With a reservoir volume of 0 the valve joins the chamber to a source of constant pressure.
// Pressures are gauge unless marked absolute. Thread: one.
#pragma once

namespace sinew::plant {

inline constexpr double kAmbientPressure_bar = 1.01325;

struct PneumaticConfig {
  double chamber_volume_m3 = 1.2e-4;       // at the rest angle
  double reservoir_volume_m3 = 2.0e-3;     // 0: constant source pressure
  double source_pressure_bar = 0.0;        // initial reservoir pressure, or that of the source
  double initial_pressure_bar = 0.0;       // chamber
  double valve_conductance_m3_s = 1.0e-3;  // bar m^3/s per bar
  double leak_conductance_m3_s = 0.0;      // chamber to ambient
  double vent_conductance_m3_s = 2.0e-4;   // reservoir to ambient
  double compressor_flow_bar_m3_s = 4.0e-4;
  double compressor_cut_out_bar = 8.0;
  // From the model: torque slope, stiffness slope, rest angle.
  double torque_slope_Nm_bar = 0.0;
  double stiffness_slope_Nm_rad_bar = 0.0;
  double rest_angle_rad = 0.0;
};

struct Relays {
  bool valve_open = false;
  bool compressor_on = false;
  bool vent_open = false;
};

class PneumaticElement {
 public:
  // Throws std::invalid_argument for a volume, conductance or pressure that cannot be.
  explicit PneumaticElement(const PneumaticConfig& config);

  void Reset(double position_rad);
  // One step at the output angle; explicit in time, exact for the exchange through the valve.
  // extra_rate: what else moves the chamber's pressure, bar/s (gas_effects.h).
  void Step(const Relays& relays, double position_rad, double dt_s,
            double extra_rate_bar_s = 0.0) noexcept;

  // The chamber's pressure from outside, in place of a Step; a change of it is a step without a
  // rate.
  void Impose(double pressure_bar, double position_rad) noexcept;

  double pressure_bar() const { return pressure_bar_; }
  double pressure_rate_bar_s() const { return pressure_rate_bar_s_; }
  double reservoir_pressure_bar() const { return reservoir_pressure_bar_; }
  double chamber_volume_m3(double position_rad) const noexcept;

 private:
  PneumaticConfig config_;
  double chamber_bar_m3_ = 0.0, reservoir_bar_m3_ = 0.0;
  double pressure_bar_ = 0.0, pressure_rate_bar_s_ = 0.0, reservoir_pressure_bar_ = 0.0;
};

}  // namespace sinew::plant
