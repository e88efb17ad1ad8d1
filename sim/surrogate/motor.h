// Brushless motor with its field-oriented current loop, in the rotor frame (d, q).
//
//     L di_d/dt = v_d - R i_d + w_e L i_q
//     L di_q/dt = v_q - R i_q - w_e (L i_d + lambda)
//     T_em = 1.5 p lambda i_q = Kt i_q
//
// w_e = p * rotor speed, p pole pairs, lambda the magnets' flux linkage (from Kt:
// amplitude-invariant transform). Kt = 60 / (2 pi KV), the thesis' (3.1); its (4.21) has a factor
// 3/2 in front of Ke: here it is inside Kt. Two PI controllers with pole cancellation (Kp =
// bandwidth L, Ki = bandwidth R) and the speed voltage fed forward; voltage limited to bus/sqrt(3),
// current reference to current_limit_A. Winding temperature: copper loss into one heat capacity,
// cooled to the surroundings. One owner; no allocation; Step is noexcept.
#pragma once

#include <array>

namespace sinew::surrogate {

struct MotorParameters {
  double torque_constant_Nm_A = 0.0159155;  // 60 / (2 pi 600)
  int pole_pairs = 7;
  double resistance_ohm = 0.12;
  double inductance_H = 4.5e-5;
  double bus_voltage_V = 24.0;
  double current_limit_A = 25.0;
  double current_bandwidth_rad_s = 1000.0;
  bool three_phase = false;
  double emf_flatness = 0.0;
  double ambient_degC = 23.0;
  double initial_rise_K = 0.0;  // of the winding over the surroundings at the start
  double heat_capacity_J_K = 35.0;
  double thermal_resistance_K_W = 3.0;
};

class Motor {
 public:
  explicit Motor(const MotorParameters& parameters);  // throws std::invalid_argument

  // Advances the windings by dt. torque_reference_Nm at the shaft. Returns the air-gap torque, N·m.
  double Step(double torque_reference_Nm, double rotor_angle_rad, double rotor_velocity_rad_s,
              double dt_s) noexcept;
  void Reset() noexcept;
  // Bus voltage over the nominal one, from now on; > 0.
  void SetSupply(double share) noexcept { supply_share_ = share; }

  double iq_A() const noexcept { return iq_A_; }
  double id_A() const noexcept { return id_A_; }
  double vq_V() const noexcept { return vq_V_; }
  double temperature_degC() const noexcept { return temperature_degC_; }
  double flux_linkage_Wb() const noexcept { return flux_linkage_Wb_; }

 private:
  double EmfShape(double electrical_rad) const noexcept;
  double StepPhases(double vq_V, double vd_V, double electrical_rad, double rotor_velocity_rad_s,
                    double dt_s) noexcept;

  MotorParameters parameters_;
  double flux_linkage_Wb_;
  double iq_A_ = 0.0;
  double id_A_ = 0.0;
  double vq_V_ = 0.0;
  std::array<double, 3> phase_A_{};
  double integral_q_V_ = 0.0;
  double integral_d_V_ = 0.0;
  double supply_share_ = 1.0;
  double temperature_degC_;
};

}  // namespace sinew::surrogate
