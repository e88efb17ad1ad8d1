#include "bench/rigs/drawn/plant.h"

#include <algorithm>
#include <cmath>

#include "bench/rigs/drawn/forces.h"
#include "bench/rigs/drawn/gas.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {

using types::kPi;
constexpr double kGravity = 9.81;

// Delays a signal by a fraction of many steps.
class Delay {
 public:
  Delay(double delay_s, double step_s)
      : steps_(delay_s / step_s), buffer_(static_cast<std::size_t>(steps_) + 3, 0.0) {}
  double Step(double x) noexcept {
    buffer_[at_] = x;
    const auto n = buffer_.size();
    const auto whole = static_cast<std::size_t>(steps_);
    const double part = steps_ - static_cast<double>(whole);
    const double late = buffer_[(at_ + n - whole) % n];
    const double later = buffer_[(at_ + n - whole - 1) % n];
    at_ = (at_ + 1) % n;
    return late + part * (later - late);
  }

 private:
  double steps_;
  std::vector<double> buffer_;
  std::size_t at_ = 0;
};

class Plant {
 public:
  Plant(const Rig& rig, const Undeclared& u, const Motion& motion)
      : rig_(rig),
        u_(u),
        motion_(motion),
        dt_(rig.step_s()),
        gas_(rig, rig.centre, motion.Pressure(0.0), u.leak_m2, u.gas_wall_s),
        delay_(u.delay_s, dt_) {
    x_ = q_ = p_ = reference_ = motion.locked() ? 0.0 : rig.centre;
    temperature_ = motion.start_degC();
    pressure_reading_ = gas_.gauge_bar();
    coupling_ = rig.coupling;
    stiffness_ = rig.stiffness;
    damping_ = rig.damping;
    play_ = rig.play + u.play;
    if (u.elastic_s > 0.0 && coupling_ == Coupling::kRigid) {
      coupling_ = Coupling::kSpring;
      const double reduced = rig.rotor_inertia * rig.link_inertia / rig.total_inertia();
      const double omega = std::min(1.0 / u.elastic_s, 0.35 / dt_);
      stiffness_ = reduced * omega * omega;
      damping_ = 0.2 * reduced * omega;
    }
    if (u.tooth_compliance > 0.0) {
      const double softer = 1.0 / (1.0 / stiffness_ + u.tooth_compliance);
      damping_ *= std::sqrt(softer / stiffness_);
      stiffness_ = softer;
    }
    control_every_ = std::max(1, static_cast<int>(std::lround(1.0 / (2000.0 * dt_))));
    const double omega = 2.0 * kPi * rig.bandwidth_Hz;
    const double arm = rig.link_length_m;
    const double inertia = rig.total_inertia() + rig.payload_kg * arm * arm;
    position_gain_ = inertia * omega * omega;
    velocity_gain_ = 1.4 * inertia * omega;
    reference_rate_ = 4.0 * kPi * rig.reference_Hz;
    typical_current_ = rig.force_scale() / Unit();
  }

  void Step();
  TrueRow Row() const;

 private:
  // Force at the output per recorded unit of drive (A or V).
  double Unit() const {
    if (rig_.drive == Drive::kCommand) return rig_.command_gain;
    if (rig_.drive == Drive::kWinding) return rig_.winding_gain;
    return rig_.efficiency * rig_.gear_ratio * rig_.torque_constant_Nm_A;
  }
  double Limit() const { return rig_.drive == Drive::kCommand ? 10.0 : rig_.current_limit_A; }
  void Control();
  double DriveForce();
  double Payload() const {
    return motion_.payload_kg() + u_.payload_kg + (t_ > u_.step_start_s ? u_.step_kg : 0.0);
  }
  double Tilt() const {
    return u_.tilt + (u_.slow_tilt == 0.0
                          ? 0.0
                          : u_.slow_tilt * std::sin(2.0 * kPi *
                                                    (0.8 * t_ / motion_.duration_s() +
                                                     0.31 * motion_.recording())));
  }
  double LinkForce(double transmitted);

  const Rig& rig_;
  const Undeclared& u_;
  const Motion& motion_;
  double dt_;
  Gas gas_;
  Delay delay_;
  Coupling coupling_ = Coupling::kRigid;
  double stiffness_ = 0, damping_ = 0, play_ = 0;
  double position_gain_ = 0, velocity_gain_ = 0, reference_rate_ = 0, typical_current_ = 1;
  int control_every_ = 1;
  long step_ = 0;
  double t_ = 0;
  double x_ = 0, xv_ = 0, q_ = 0, v_ = 0;  // motor and link
  double p_ = 0, pv_ = 0;                  // tip of a flexible link
  double reference_ = 0, reference_v_ = 0;
  double command_ = 0, current_ = 0, supply_ = 0;
  double zeta_ = 0, seal_ = 0, rested_s_ = 1.0, stuck_extra_ = 0;
  double tooth_ = 0, drive_force_ = 0, hand_ = 0;
  double temperature_ = 25, pressure_reading_ = 0, regulator_ = 0, warm_ = 1;
  bool open_ = false;
};

void Plant::Control() {
  const double period = control_every_ * dt_;
  // Reference through two equal lags: no steps of acceleration.
  const double w = reference_rate_;
  const double accel = w * w * (motion_.Reference(t_) - reference_) - 2.0 * w * reference_v_;
  reference_v_ += accel * period;
  reference_ += reference_v_ * period;
  const bool motor_side = coupling_ != Coupling::kRigid;
  const double position = motor_side ? x_ : q_, velocity = motor_side ? xv_ : v_;
  const double error = reference_ - position;
  const double force =
      position_gain_ * error + velocity_gain_ * (reference_v_ - velocity) +
      rig_.total_inertia() * accel -
      (rig_.family == Family::kCylinder ? rig_.pneumatic_slope * pressure_reading_ : 0.0) +
      (rig_.gravity_torque + kGravity * rig_.link_length_m * motion_.payload_kg()) *
          std::cos(position);
  if (rig_.drive == Drive::kWinding) {
    supply_ = rig_.supply_V - rig_.supply_sag_V_Nm * std::abs(drive_force_);
    const double volts = position_gain_ * error / rig_.winding_gain;
    command_ = std::clamp(volts, -supply_, supply_);
  } else {
    command_ = std::clamp(force / Unit(), -Limit(), Limit());
  }
  regulator_ = motion_.Pressure(t_);
  open_ = rig_.pressure && (!rig_.valve || motion_.Valve(t_));
  hand_ = motion_.locked() ? hand_ : motion_.Hand(t_);
  warm_ = 1.0 + (u_.warm_up == 0.0
                     ? 0.0
                     : u_.warm_up * std::exp(-t_ / (u_.warm_shape[0] * motion_.duration_s())));
  warm_ *= std::max(0.1, 1.0 - u_.warm_share * (temperature_ - 25.0));
  const double heat = command_ / typical_current_;
  const double tau = 0.3 * motion_.duration_s();
  temperature_ +=
      (motion_.ambient_degC() + std::min(30.0, 12.0 * heat * heat) - temperature_) / tau * period;
}

double Plant::DriveForce() {
  if (rig_.drive == Drive::kWinding) {
    current_ = command_;
    const double late = u_.delay_s > 0.0 ? delay_.Step(current_) : current_;
    return rig_.winding_gain * (late - rig_.back_emf_V_s_rad * rig_.gear_ratio * xv_);
  }
  current_ += (command_ - current_) * std::min(1.0, dt_ / rig_.current_lag_s);
  double acting = u_.delay_s > 0.0 ? delay_.Step(current_) : current_;
  acting = Saturated(u_, acting, Limit()) * (1.0 + u_.drive_gain);
  if (u_.sag != 0.0) {
    const double power = acting * xv_ / (typical_current_ * rig_.speed());
    acting *= 1.0 - u_.sag * std::clamp(power, 0.0, 1.0);
  }
  if (u_.backward_gain != 0.0) {
    const double power = acting * xv_ / (0.02 * typical_current_ * rig_.speed());
    acting *= 1.0 + 0.5 * u_.backward_gain * (1.0 - std::tanh(power));
  }
  return Unit() * acting;
}

// Everything that acts on the link but the teeth.
double Plant::LinkForce(double transmitted) {
  double force = rig_.offset;
  if (rig_.gravity_torque > 0.0) {
    const double weight = rig_.gravity_torque + Payload() * kGravity * rig_.link_length_m;
    force -= weight * std::cos(q_ + Tilt());
  }
  const double pressure = gas_.gauge_bar();
  double full = 1.0;
  if (u_.collapse != 0.0) {
    const double s = std::max(0.0, pressure) / u_.collapse_shape[0];
    full = 1.0 - u_.collapse / (1.0 + s * s * s);
  }
  force += full * (rig_.pneumatic_slope - rig_.pneumatic_stiffness * (q_ - rig_.rest_position)) *
           pressure;
  if (hand_ != 0.0) {
    const double askew = 1.0 + u_.cell_angle * std::sin(q_) - 0.5 * u_.cell_angle * q_ * q_;
    force -= hand_ * rig_.link_length_m * askew;
  }
  force -= rig_.link_viscous * warm_ * v_;
  if (u_.viscous_asymmetry != 0.0) force -= u_.viscous_asymmetry * std::abs(v_);
  force += PositionForce(u_, q_, rig_.amplitude) + EventForce(u_, t_);

  double level = rig_.coulomb * warm_;
  if (u_.stribeck != 0.0) {
    const double s = v_ / u_.stribeck_speed;
    level += u_.stribeck / (1.0 + s * s);
  }
  level += u_.load_share * std::abs(transmitted);
  level += u_.pressure_friction * std::max(0.0, pressure);
  if (u_.rest_stiction != 0.0) {
    const bool rest = std::abs(v_) < 0.004 * rig_.speed();
    rested_s_ = rest ? rested_s_ + dt_ : 0.0;
    const double target =
        rest ? u_.rest_stiction * (1.0 - std::exp(-rested_s_ / u_.rest_shape[0])) : 0.0;
    stuck_extra_ = rest ? std::max(stuck_extra_, target)
                        : stuck_extra_ * (1.0 - std::min(1.0, dt_ / (0.04 / rig_.frequency_Hz)));
    level += stuck_extra_;
  }
  if (u_.coulomb_asymmetry != 0.0) {
    level = std::max(0.05 * level, level + u_.coulomb_asymmetry * (zeta_ > 0.0 ? 1.0 : -1.0));
  }
  const double body = rig_.link_inertia + (coupling_ == Coupling::kRigid ? rig_.rotor_inertia : 0);
  const double length = std::max(rig_.bristle, level / body * dt_ * dt_ / 0.1225) + u_.presliding;
  zeta_ = StepBristle(zeta_, v_, length, dt_, true);
  // The bristle's own damping fades as soon as it slides.
  const double fade = std::exp(-std::abs(v_) * 0.02 / length);
  force -= level * zeta_ + 0.3 * std::sqrt(level / length * body) * v_ * fade;
  if (u_.seal != 0.0) {
    seal_ = StepBristle(seal_, v_, u_.seal_shape[0], dt_, false);
    force -= u_.seal * std::max(0.0, pressure) * seal_;
  }
  return force;
}

void Plant::Step() {
  if (step_ % control_every_ == 0) Control();
  ++step_;
  t_ += dt_;
  drive_force_ = DriveForce();
  double motor_force = drive_force_ - rig_.motor_viscous * warm_ * xv_;
  if (u_.quadratic != 0.0) {
    const double s = std::abs(xv_) / rig_.speed();
    motor_force -= u_.quadratic * std::copysign(s * std::sqrt(s) * std::sqrt(0.15 + s), xv_);
  }
  if (u_.cogging != 0.0) motor_force += MotorForce(u_, rig_.gear_ratio * x_);

  if (motion_.locked()) {
    x_ = xv_ = 0.0;
    const double k = rig_.link_inertia * 2500.0;
    hand_ = -(k * (motion_.HandTarget(t_) - q_) - 2.0 * rig_.link_inertia * 50.0 * v_) /
            rig_.link_length_m;
  }
  double inertia = rig_.link_inertia + Payload() * rig_.link_length_m * rig_.link_length_m;
  double tip = 0.0;
  if (u_.flexible_share > 0.0) {
    const double moved = std::min(0.8, u_.flexible_share) * rig_.link_inertia;
    const double w = 2.0 * kPi * u_.flexible_shape[0];
    tip = moved * (w * w * (q_ - p_) + 2.0 * u_.flexible_shape[1] * w * (v_ - pv_));
    inertia -= moved;
    pv_ += tip / moved * dt_;
    p_ += pv_ * dt_;
  }
  if (coupling_ == Coupling::kRigid) {
    const double force = motor_force + LinkForce(drive_force_) - tip;
    tooth_ = drive_force_;
    v_ += force / (inertia + rig_.rotor_inertia) * dt_;
    q_ += v_ * dt_;
    x_ = q_;
    xv_ = v_;
  } else {
    const double gap = x_ - q_;
    const double half = coupling_ == Coupling::kPlay ? 0.5 * play_ : 0.0;
    const double pressed = gap > half ? gap - half : gap < -half ? gap + half : 0.0;
    const double pulled = stiffness_ * pressed / rig_.force_scale();
    tooth_ = stiffness_ * pressed * (1.0 + rig_.stiffening * pulled * pulled) +
             (half == 0.0 || pressed != 0.0 ? damping_ * (xv_ - v_) : 0.0);
    if (half > 0.0 && tooth_ * pressed <= 0.0) tooth_ = 0.0;
    const double link = LinkForce(tooth_) + tooth_ - tip;
    v_ += link / inertia * dt_;
    q_ += v_ * dt_;
    if (!motion_.locked()) {
      xv_ += (motor_force - tooth_) / rig_.rotor_inertia * dt_;
      x_ += xv_ * dt_;
    }
  }
  if (rig_.pressure) {
    gas_.Step(q_, regulator_, open_, dt_);
    const double lag = u_.pressure_lag_s + 3e-4;  // of the sensor itself
    pressure_reading_ += (gas_.gauge_bar() - pressure_reading_) * std::min(1.0, dt_ / lag);
  }
}

TrueRow Plant::Row() const {
  TrueRow row;
  row.time_s = t_;
  row.motor = x_;
  row.true_position = q_;
  // One encoder reads what the motor does, whatever bends behind it.
  const bool on_motor = !rig_.output_encoder;
  row.position = on_motor ? x_ : q_;
  row.velocity = on_motor ? xv_ : v_;
  row.motor_velocity = xv_;
  if (u_.encoder_wave != 0.0) {
    row.position += u_.encoder_wave * std::sin(u_.encoder_shape[0] * q_ + u_.encoder_shape[1]);
  }
  for (const double slip : u_.slips_s) row.position += t_ > slip ? u_.slip : 0.0;
  row.drive = rig_.drive == Drive::kSensor ? tooth_ : current_ + u_.current_offset;
  row.supply_V = supply_;
  row.pressure_bar = pressure_reading_ * (1.0 + u_.pressure_gain) + u_.pressure_offset;
  row.load_force_N = hand_ * (1.0 + u_.cell_gain);
  row.valve_open = open_;
  row.payload_kg = motion_.payload_kg();
  row.temperature_degC = temperature_;
  row.reference = reference_;
  row.tooth_force = tooth_;
  row.true_drive_force = drive_force_;
  row.true_pressure_bar = gas_.gauge_bar();
  return row;
}

}  // namespace

std::vector<TrueRow> Simulate(const Rig& rig, const std::vector<Effect>& effects,
                              const Motion& motion) {
  const Undeclared u = Resolve(rig, effects, motion);
  Plant plant(rig, u, motion);
  // The servo settles before the record begins.
  const int settle = static_cast<int>(std::ceil(0.5 / rig.frequency_Hz / rig.step_s()));
  std::vector<TrueRow> rows;
  rows.reserve(static_cast<std::size_t>(rig.rows));
  for (int i = 0; i < settle / 4; ++i) plant.Step();
  for (int row = 0; row < rig.rows; ++row) {
    for (int i = 0; i < rig.steps_per_row; ++i) plant.Step();
    rows.push_back(plant.Row());
  }
  return rows;
}

}  // namespace sinew::rigs
