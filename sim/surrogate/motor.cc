#include "sim/surrogate/motor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace sinew::surrogate {

Motor::Motor(const MotorParameters& parameters)
    : parameters_(parameters),
      flux_linkage_Wb_(parameters.torque_constant_Nm_A / (1.5 * parameters.pole_pairs)),
      temperature_degC_(parameters.ambient_degC) {
  const MotorParameters& p = parameters;
  if (!(p.torque_constant_Nm_A > 0.0) || p.pole_pairs < 1 || !(p.resistance_ohm > 0.0) ||
      !(p.inductance_H > 0.0) || !(p.bus_voltage_V > 0.0) || !(p.current_limit_A > 0.0) ||
      !(p.current_bandwidth_rad_s > 0.0) || !(p.heat_capacity_J_K > 0.0) ||
      !(p.thermal_resistance_K_W > 0.0)) {
    throw std::invalid_argument("motor parameters must be positive");
  }
}

void Motor::Reset() noexcept {
  iq_A_ = id_A_ = vq_V_ = integral_q_V_ = integral_d_V_ = 0.0;
  temperature_degC_ = parameters_.ambient_degC;
}

double Motor::Step(double torque_reference_Nm, double rotor_velocity_rad_s, double dt_s) noexcept {
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
  const double limit_V = p.bus_voltage_V / std::numbers::sqrt3;
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
  iq_A_ += dt_s / p.inductance_H * (vq_V - p.resistance_ohm * iq_A_ - speed_voltage_q_V);
  id_A_ += dt_s / p.inductance_H * (vd_V - p.resistance_ohm * id_A_ - speed_voltage_d_V);

  const double copper_loss_W = 1.5 * p.resistance_ohm * (iq_A_ * iq_A_ + id_A_ * id_A_);
  temperature_degC_ +=
      dt_s / p.heat_capacity_J_K *
      (copper_loss_W - (temperature_degC_ - p.ambient_degC) / p.thermal_resistance_K_W);
  return p.torque_constant_Nm_A * iq_A_;
}

}  // namespace sinew::surrogate
