#include "sim/surrogate/motor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace sinew::surrogate {

Motor::Motor(const MotorParameters& parameters)
    : parameters_(parameters),
      flux_linkage_Wb_(parameters.torque_constant_Nm_A / (1.5 * parameters.pole_pairs)),
      temperature_degC_(parameters.ambient_degC + parameters.initial_rise_K) {
  const MotorParameters& p = parameters;
  if (!(p.torque_constant_Nm_A > 0.0) || p.pole_pairs < 1 || !(p.resistance_ohm > 0.0) ||
      !(p.inductance_H > 0.0) || !(p.bus_voltage_V > 0.0) || !(p.current_limit_A > 0.0) ||
      !(p.current_bandwidth_rad_s > 0.0) || !(p.heat_capacity_J_K > 0.0) ||
      !(p.thermal_resistance_K_W > 0.0) || !(p.emf_flatness >= 0.0) || !(p.emf_flatness <= 1.0)) {
    throw std::invalid_argument("motor parameters must be positive, emf_flatness in [0, 1]");
  }
}

void Motor::Reset() noexcept {
  phase_A_.fill(0.0);
  iq_A_ = id_A_ = vq_V_ = integral_q_V_ = integral_d_V_ = 0.0;
  temperature_degC_ = parameters_.ambient_degC + parameters_.initial_rise_K;
  supply_share_ = 1.0;
}

double Motor::EmfShape(double electrical_rad) const noexcept {
  const double sine = std::sin(electrical_rad);
  if (parameters_.emf_flatness == 0.0) return sine;
  // Trapezoid with corners at 30 degrees; its fundamental is 12 sin(30 deg) / (pi pi / 2) = 1.2159.
  constexpr double kFundamental = 12.0 / (std::numbers::pi * std::numbers::pi);
  const double ramp = std::asin(sine) / (std::numbers::pi / 6.0);
  const double trapezoid = std::clamp(ramp, -1.0, 1.0) / kFundamental;
  return sine + parameters_.emf_flatness * (trapezoid - sine);
}

double Motor::StepPhases(double vq_V, double vd_V, double electrical_rad,
                         double rotor_velocity_rad_s, double dt_s) noexcept {
  constexpr double kThird_rad = 2.0 * std::numbers::pi / 3.0;
  const double emf_constant_V_s = parameters_.torque_constant_Nm_A / 1.5;
  std::array<double, 3> shape{}, drive_V{};
  double neutral_V = 0.0;
  for (int x = 0; x < 3; ++x) {
    const double angle_rad = electrical_rad - x * kThird_rad;
    shape[x] = EmfShape(angle_rad);
    // The q axis lies along the back EMF (sine), the d axis a quarter turn behind it.
    drive_V[x] = vq_V * std::sin(angle_rad) + vd_V * std::cos(angle_rad) -
                 emf_constant_V_s * shape[x] * rotor_velocity_rad_s;
    neutral_V += drive_V[x] / 3.0;
  }
  double torque_Nm = 0.0;
  iq_A_ = id_A_ = 0.0;
  for (int x = 0; x < 3; ++x) {
    phase_A_[x] += dt_s / parameters_.inductance_H *
                   (drive_V[x] - neutral_V - parameters_.resistance_ohm * phase_A_[x]);
    torque_Nm += emf_constant_V_s * shape[x] * phase_A_[x];
    const double angle_rad =
        electrical_rad + parameters_.pole_pairs * rotor_velocity_rad_s * dt_s - x * kThird_rad;
    iq_A_ += 2.0 / 3.0 * phase_A_[x] * std::sin(angle_rad);
    id_A_ += 2.0 / 3.0 * phase_A_[x] * std::cos(angle_rad);
  }
  return torque_Nm;
}

double Motor::Step(double torque_reference_Nm, double rotor_angle_rad, double rotor_velocity_rad_s,
                   double dt_s) noexcept {
  const MotorParameters& p = parameters_;
  const double reference_A = std::clamp(torque_reference_Nm / p.torque_constant_Nm_A,
                                        -p.current_limit_A, p.current_limit_A);
  const double electrical_rad_s = p.pole_pairs * rotor_velocity_rad_s;
  const double gain_V_A = p.current_bandwidth_rad_s * p.inductance_H;
  const double integral_gain_V_As = p.current_bandwidth_rad_s * p.resistance_ohm;
  const double error_q_A = reference_A - iq_A_;
  const double error_d_A = -id_A_;
  const double speed_voltage_q_V = electrical_rad_s * (p.inductance_H * id_A_ + flux_linkage_Wb_);
  const double speed_voltage_d_V = -electrical_rad_s * p.inductance_H * iq_A_;
  double vq_V = gain_V_A * error_q_A + integral_q_V_ + speed_voltage_q_V;
  double vd_V = gain_V_A * error_d_A + integral_d_V_ + speed_voltage_d_V;
  const double limit_V = supply_share_ * p.bus_voltage_V / std::numbers::sqrt3;
  const double squared_V2 = vq_V * vq_V + vd_V * vd_V;
  if (squared_V2 > limit_V * limit_V) {
    const double scale = limit_V / std::sqrt(squared_V2);
    vq_V *= scale;
    vd_V *= scale;
  } else {
    integral_q_V_ += integral_gain_V_As * error_q_A * dt_s;
    integral_d_V_ += integral_gain_V_As * error_d_A * dt_s;
  }
  vq_V_ = vq_V;
  double torque_Nm = 0.0;
  if (p.three_phase) {
    torque_Nm = StepPhases(vq_V, vd_V, p.pole_pairs * rotor_angle_rad, rotor_velocity_rad_s, dt_s);
  } else {
    iq_A_ += dt_s / p.inductance_H * (vq_V - p.resistance_ohm * iq_A_ - speed_voltage_q_V);
    id_A_ += dt_s / p.inductance_H * (vd_V - p.resistance_ohm * id_A_ - speed_voltage_d_V);
    torque_Nm = p.torque_constant_Nm_A * iq_A_;
  }

  const double copper_loss_W = 1.5 * p.resistance_ohm * (iq_A_ * iq_A_ + id_A_ * id_A_);
  temperature_degC_ +=
      dt_s / p.heat_capacity_J_K *
      (copper_loss_W - (temperature_degC_ - p.ambient_degC) / p.thermal_resistance_K_W);
  return torque_Nm;
}

}  // namespace sinew::surrogate
