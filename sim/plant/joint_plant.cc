#include "sim/plant/joint_plant.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "components/base/types/require.h"
#include "sim/plant/friction.h"

namespace sinew::plant {

namespace {

constexpr double kSmallVelocity = 1e-9;  // friction at rest is that of the slowest motion

bool Needs(const effects::EffectInfo& info, std::initializer_list<std::string_view> fields) {
  return std::any_of(info.needs.begin(), info.needs.end(), [&](const std::string& need) {
    return std::find(fields.begin(), fields.end(), need) != fields.end();
  });
}

bool IsLinkInertia(const effects::EffectInfo& info) {
  return info.role == effects::Role::kInertia && info.side == effects::Side::kOutput;
}

}  // namespace

JointPlant::JointPlant(const actuator::JointModel& model, const JointPlantConfig& config)
    : model_(model), config_(config) {
  const auto positive = [](const char* name, double value) {
    types::Require(value > 0.0, name, value, "above 0");
  };
  positive("contact_stiffness_Nm_rad", config.contact_stiffness_Nm_rad);
  positive("position_gain_1_s", config.position_gain_1_s);
  positive("velocity_bandwidth_rad_s", config.velocity_bandwidth_rad_s);
  types::Require(config.contact_damping_ratio >= 0.0, "contact_damping_ratio",
                 config.contact_damping_ratio, "at least 0");
  types::Require(config.velocity_integral_1_s >= 0.0, "velocity_integral_1_s",
                 config.velocity_integral_1_s, "at least 0");
  gear_ratio_ = model_.constants.gear_ratio;
  positive("gear_ratio", gear_ratio_);
  play_rad_ = model_.backlash_rad;
  double compliance_rad_Nm = 0.0;
  for (const actuator::Term& term : model_.terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.balance != effects::Balance::kKinematic) continue;
    if (info.name == "backlash_width") play_rad_ += term.linear[0].value;
    if (info.name == "gear_compliance") compliance_rad_Nm += term.linear[0].value;
    if (info.name == "free_play") compliance_rad_Nm += term.linear[1].value;
  }
  types::Require(compliance_rad_Nm >= 0.0, "compliance of the teeth in rad/Nm", compliance_rad_Nm,
                 "at least 0");
  stiffest_contact_Nm_rad_ =
      compliance_rad_Nm > 0.0 ? std::min(config.contact_stiffness_Nm_rad, 1.0 / compliance_rad_Nm)
                              : config.contact_stiffness_Nm_rad;
  types::Require(play_rad_ >= 0.0, "backlash_rad", play_rad_, "at least 0");
  ideal_drive_gain_ = effects::IdealDriveGain(model_.constants);

  std::size_t memory_at = 0;
  bool has_payload = false, has_load_force = false;
  for (std::size_t i = 0; i < model_.terms.size(); ++i) {
    const actuator::Term& term = model_.terms[i];
    const effects::EffectInfo& info = term.effect->info();
    CompiledTerm compiled;
    compiled.effect = term.effect.get();
    compiled.linear = term.linear.size();
    compiled.nonlinear = term.nonlinear.size();
    for (std::size_t k = 0; k < term.linear.size(); ++k) compiled.theta[k] = term.linear[k].value;
    for (std::size_t k = 0; k < term.nonlinear.size(); ++k) {
      compiled.psi[k] = term.nonlinear[k].value;
    }
    compiled.memory_at = memory_at;
    compiled.memory_size = static_cast<std::size_t>(term.effect->memory_size());
    memory_at += compiled.memory_size;
    if (info.name == "encoder_eccentricity") encoder_.push_back(compiled);
    if (!model_.Counts(term)) continue;
    if (compiled.memory_size > 0) with_memory_.push_back(compiled);
    if (info.role == effects::Role::kDrive) drive_.push_back(compiled);
    if (info.name == "transport_delay") {
      drive_lag_s_ =
          std::max(drive_lag_s_, std::abs(actuator::PhysicalValue(model_, static_cast<int>(i), 0)));
    }
    has_payload |= info.name == "declared_payload";
    has_load_force |= info.name == "load_force";
    if (config_.link_inertia_in_body && IsLinkInertia(info)) continue;

    Body& body = has_play() && info.side == effects::Side::kMotor ? motor_ : output_;
    const bool reads_velocity = Needs(info, {"velocity_rad_s", "motor_velocity_rad_s"});
    (reads_velocity ? body.velocity : body.steady).push_back(compiled);
    if (Needs(info, {"acceleration_rad_s2", "motor_acceleration_rad_s2"})) {
      body.acceleration.push_back(compiled);
    }
    if (Needs(info, {"jerk_rad_s3"})) body.jerk.push_back(compiled);
    if (Needs(info, {"snap_rad_s4"})) body.snap.push_back(compiled);
  }
  memory_.resize(memory_at);
  adds_payload_ = !has_payload;
  adds_load_force_ = !has_load_force;
  if (has_play()) {
    rotor_inertia_kg_m2_ = ForcesOn(motor_, 0.0, false, true).inertia;
    types::Require(rotor_inertia_kg_m2_ > 0.0,
                   "joint '" + model_.name + "' has free play: rotor_inertia", rotor_inertia_kg_m2_,
                   "above 0");
  }
  sample_.temperature_degC = config_.motor_temperature_degC;
}

double JointPlant::LinkInertia(const actuator::JointModel& model) {
  double inertia = 0.0;
  for (const actuator::Term& term : model.terms) {
    if (IsLinkInertia(term.effect->info())) inertia += term.linear[0].value;
  }
  return inertia;
}

void JointPlant::Reset(double position_rad, double body_inertia_kg_m2) {
  const double temperature = sample_.temperature_degC;
  sample_ = effects::JointSample{};
  sample_.temperature_degC = temperature;
  sample_.position_rad = position_rad;
  sample_.motor_position_rad = gear_ratio_ * position_rad;
  rotor_position_rad_ = position_rad;
  rotor_velocity_rad_s_ = 0.0;
  body_inertia_kg_m2_ = body_inertia_kg_m2;
  tooth_torque_Nm_ = integrator_Nm_ = lagged_drive_ = last_velocity_ = 0.0;
  filtered_acceleration_ = filtered_jerk_ = 0.0;
  command_ = {};
  for (const CompiledTerm& term : with_memory_) {
    term.effect->ResetMemory(sample_, {term.psi.data(), term.nonlinear},
                             std::span(memory_).subspan(term.memory_at, term.memory_size));
  }
  const double total = body_inertia_kg_m2 + ForcesOn(output_, 0.0, true, !has_play()).inertia;
  types::Require(total > 0.0, "joint '" + model_.name + "': inertia at the output", total,
                 "above 0");
  controlled_inertia_kg_m2_ = has_play() ? rotor_inertia_kg_m2_ : total;

  // Terms in jerk c and snap d through the filter a / (1 + s tau): stable for c > -J tau, d > -J
  // tau^2.
  motion_filter_s_ = 1e-3;
  effects::JointSample moving = sample_;
  moving.jerk_rad_s3 = 1.0;
  const double c = Sum(output_.jerk, sample_) - Sum(output_.jerk, moving);
  moving = sample_;
  moving.snap_rad_s4 = 1.0;
  const double d = Sum(output_.snap, sample_) - Sum(output_.snap, moving);
  // With free play the link rings on its teeth, and there the filter's phase turns a positive term
  // into negative damping; at these times what is left of it is small beside that of the teeth.
  motion_filter_s_ =
      std::max({motion_filter_s_, 2.0 * (has_play() ? std::abs(c) : -c) / total,
                std::sqrt(4.0 * std::max(0.0, has_play() ? std::abs(d) : -d) / total)});
}

void JointPlant::SetRotor(double motor_position_rad, double motor_velocity_rad_s) noexcept {
  if (!has_play()) return;
  rotor_position_rad_ = motor_position_rad / gear_ratio_;
  rotor_velocity_rad_s_ = motor_velocity_rad_s / gear_ratio_;
  sample_.motor_position_rad = motor_position_rad;
  sample_.motor_velocity_rad_s = motor_velocity_rad_s;
}

void JointPlant::SetCommand(const DriveCommand& command) noexcept {
  if (command.mode != command_.mode) integrator_Nm_ = 0.0;
  command_ = command;
  const bool finite = std::isfinite(command.motor_torque_Nm) &&
                      std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_s);
  if (!finite) command_ = DriveCommand{};
}

void JointPlant::SetLoad(double hand_force_N, double payload_kg) noexcept {
  sample_.load_force_N = hand_force_N;
  sample_.payload_kg = payload_kg;
}

void JointPlant::SetPressure(double pressure_bar, double rate_bar_s) noexcept {
  sample_.pressure_bar = pressure_bar;
  sample_.pressure_rate_bar_s = rate_bar_s;
}

void JointPlant::SetMotorTemperature(double temperature_degC) noexcept {
  sample_.temperature_degC = temperature_degC;
}

void JointPlant::SetSurroundings(const effects::JointSample& x) noexcept {
  sample_.time_s = x.time_s;
  sample_.pressure_bar = x.pressure_bar;
  sample_.pressure_rate_bar_s = x.pressure_rate_bar_s;
  sample_.load_force_N = adds_load_force_ ? 0.0 : x.load_force_N;
  sample_.payload_kg = adds_payload_ ? 0.0 : x.payload_kg;
  sample_.temperature_degC = x.temperature_degC;
  sample_.valve_open = x.valve_open;
}

void JointPlant::SetMemory(std::span<const double> memory) noexcept {
  std::copy_n(memory.begin(), std::min(memory.size(), memory_.size()), memory_.begin());
}

double JointPlant::Evaluate(const CompiledTerm& term,
                            const effects::JointSample& x) const noexcept {
  std::array<double, effects::kMaxParameters> phi{};
  term.effect->Regressors(
      x, {term.psi.data(), term.nonlinear},
      std::span<const double>(memory_).subspan(term.memory_at, term.memory_size),
      {phi.data(), term.linear});
  double torque = 0.0;
  for (std::size_t i = 0; i < term.linear; ++i) torque += term.theta[i] * phi[i];
  return torque;
}

double JointPlant::Sum(const std::vector<CompiledTerm>& terms,
                       const effects::JointSample& x) const noexcept {
  double torque = 0.0;
  for (const CompiledTerm& term : terms) torque += Evaluate(term, x);
  return torque;
}

JointPlant::Forces JointPlant::ForcesOn(const Body& body, double velocity, bool reverses_output,
                                        bool reverses_motor) noexcept {
  Forces forces;
  forces.torque = Sum(body.steady, sample_);
  if (!body.velocity.empty()) {
    const double speed = std::max(std::abs(velocity), kSmallVelocity);
    effects::JointSample x = sample_;
    if (reverses_output) x.velocity_rad_s = speed;
    if (reverses_motor) x.motor_velocity_rad_s = gear_ratio_ * speed;
    const double forward = Sum(body.velocity, x);
    if (reverses_output) x.velocity_rad_s = -speed;
    if (reverses_motor) x.motor_velocity_rad_s = -gear_ratio_ * speed;
    const double backward = Sum(body.velocity, x);
    forces.torque += 0.5 * (forward + backward);
    const double odd = 0.5 * (forward - backward);
    if (odd <= 0.0) {
      forces.friction = -odd;
    } else if (velocity != 0.0) {
      forces.torque += std::copysign(odd, velocity);  // a term that drives: no bound, a torque
    }
  }
  if (!body.acceleration.empty()) {
    effects::JointSample x = sample_;
    x.acceleration_rad_s2 = x.motor_acceleration_rad_s2 = 0.0;
    const double still = Sum(body.acceleration, x);
    x.acceleration_rad_s2 = 1.0;
    x.motor_acceleration_rad_s2 = gear_ratio_;
    forces.inertia = still - Sum(body.acceleration, x);
  }
  return forces;
}

void JointPlant::UpdateDrive(double dt_s) noexcept {
  double torque = 0.0;  // at the shaft
  if (command_.mode == types::ControlMode::kTorque) {
    torque = command_.motor_torque_Nm;
  } else if (command_.mode != types::ControlMode::kIdle) {
    const double correction =
        command_.mode == types::ControlMode::kPosition
            ? config_.position_gain_1_s * (command_.position_rad - rotor_position_rad_)
            : 0.0;
    const double error = command_.velocity_rad_s + correction - rotor_velocity_rad_s_;
    const double gain = controlled_inertia_kg_m2_ * config_.velocity_bandwidth_rad_s;
    torque = (gain * error + integrator_Nm_) / gear_ratio_;
    const double limit = model_.motor_torque_limit_Nm;
    // No wind-up: the integrator stands still while the limit holds and it would go further.
    const bool held = limit > 0.0 && std::abs(torque) >= limit && torque * error > 0.0;
    if (!held) integrator_Nm_ += gain * config_.velocity_integral_1_s * error * dt_s;
  }
  if (model_.motor_torque_limit_Nm > 0.0) {
    torque = std::clamp(torque, -model_.motor_torque_limit_Nm, model_.motor_torque_limit_Nm);
  }
  sample_.drive_input = torque * gear_ratio_ / ideal_drive_gain_;
  if (drive_lag_s_ > 0.0) {
    // The rate over the step, so that a ramp comes late by the delay itself.
    const double before = lagged_drive_;
    lagged_drive_ += -std::expm1(-dt_s / drive_lag_s_) * (sample_.drive_input - lagged_drive_);
    sample_.drive_rate = (sample_.drive_input - 0.5 * (before + lagged_drive_)) / drive_lag_s_;
  }
}

double JointPlant::encoder_error_rad() const noexcept { return Sum(encoder_, sample_); }

void JointPlant::MoveTo(double position_rad, double velocity_rad_s, double dt_s) noexcept {
  if (has_play()) {
    rotor_position_rad_ += 0.5 * dt_s * rotor_velocity_rad_s_;
  } else {
    rotor_position_rad_ = position_rad;
    rotor_velocity_rad_s_ = velocity_rad_s;
  }
  sample_.position_rad = position_rad;
  sample_.velocity_rad_s = velocity_rad_s;
  sample_.motor_position_rad = gear_ratio_ * rotor_position_rad_;
  sample_.motor_velocity_rad_s = gear_ratio_ * rotor_velocity_rad_s_;
}

LinkLoad JointPlant::Begin(double position_rad, double velocity_rad_s, double dt_s) noexcept {
  MoveTo(position_rad, velocity_rad_s, dt_s);
  last_velocity_ = velocity_rad_s;
  UpdateDrive(dt_s);

  const Forces on_link = ForcesOn(output_, velocity_rad_s, true, !has_play());
  LinkLoad load{.torque_Nm = on_link.torque,
                .added_inertia_kg_m2 = on_link.inertia,
                .friction_Nm = on_link.friction};
  const bool rotary = model_.kind == types::JointKind::kRevolute;
  const double arm = rotary ? model_.constants.link_length_m : 1.0;
  if (adds_load_force_) load.torque_Nm -= sample_.load_force_N * arm;
  if (adds_payload_) {
    load.added_inertia_kg_m2 += sample_.payload_kg * arm * arm;
    if (rotary) {
      load.torque_Nm -=
          sample_.payload_kg * model_.constants.gravity_m_s2 * arm * std::cos(position_rad);
    }
  }
  if (!output_.jerk.empty() || !output_.snap.empty()) {
    // With a = (v' - v) / dt unknown, jerk and snap are linear in it: offset and slope by
    // evaluation.
    const double tau = dt_s / -std::expm1(-dt_s / motion_filter_s_);  // exact for a ramp
    effects::JointSample x = sample_;
    const auto torque_at = [&](double acceleration) {
      x.jerk_rad_s3 = (acceleration - filtered_acceleration_) / tau;
      x.snap_rad_s4 = (x.jerk_rad_s3 - filtered_jerk_) / tau;
      return Sum(output_.jerk, x) + Sum(output_.snap, x);
    };
    const double offset = torque_at(0.0);
    load.torque_Nm += offset;
    load.added_inertia_kg_m2 -= torque_at(1.0) - offset;
  }

  if (has_play()) {
    const double link_inertia = std::max(body_inertia_kg_m2_ + load.added_inertia_kg_m2, 1e-9);
    const double reduced =
        rotor_inertia_kg_m2_ * link_inertia / (rotor_inertia_kg_m2_ + link_inertia);
    // A quarter of the stability bound of the step.
    const double stiffness = std::min(stiffest_contact_Nm_rad_, 0.25 * reduced / (dt_s * dt_s));
    const double damping = 2.0 * config_.contact_damping_ratio * std::sqrt(stiffness * reduced);
    contact_stiffness_Nm_rad_ = stiffness;
    const double gap = rotor_position_rad_ - position_rad;
    const double closing = rotor_velocity_rad_s_ - velocity_rad_s;
    const double depth = std::abs(gap) - 0.5 * play_rad_;
    tooth_torque_Nm_ = 0.0;
    if (depth > 0.0) {
      const double side = std::copysign(1.0, gap);
      tooth_torque_Nm_ = side * std::max(0.0, stiffness * depth + damping * side * closing);
    }
    load.torque_Nm += tooth_torque_Nm_;

    const Forces on_rotor = ForcesOn(motor_, rotor_velocity_rad_s_, false, true);
    const double inverse = 1.0 / rotor_inertia_kg_m2_;
    rotor_velocity_rad_s_ += dt_s * inverse * (on_rotor.torque - tooth_torque_Nm_);
    const double bound = dt_s * on_rotor.friction, lower = -bound;
    double impulse = 0.0;
    ApplyImpulses({&inverse, 1}, {&lower, 1}, {&bound, 1}, {&impulse, 1},
                  {&rotor_velocity_rad_s_, 1});
  }
  return load;
}

void JointPlant::End(double position_rad, double velocity_rad_s, double dt_s) noexcept {
  MoveTo(position_rad, velocity_rad_s, dt_s);
  if (!output_.jerk.empty() || !output_.snap.empty()) {
    const double acceleration = (velocity_rad_s - last_velocity_) / dt_s;
    const double share = -std::expm1(-dt_s / motion_filter_s_);
    const double jerk = (acceleration - filtered_acceleration_) * share / dt_s;
    filtered_acceleration_ += share * (acceleration - filtered_acceleration_);
    filtered_jerk_ += share * (jerk - filtered_jerk_);
  }
  sample_.time_s += dt_s;
  effects::JointSample moved = sample_;
  moved.acceleration_rad_s2 = (velocity_rad_s - last_velocity_) / dt_s;
  moved.motor_acceleration_rad_s2 = gear_ratio_ * moved.acceleration_rad_s2;
  for (const CompiledTerm& term : with_memory_) {
    term.effect->Advance(moved, dt_s, {term.psi.data(), term.nonlinear},
                         std::span(memory_).subspan(term.memory_at, term.memory_size));
  }
}

double JointPlant::motor_position_rad() const noexcept { return gear_ratio_ * rotor_position_rad_; }
double JointPlant::motor_velocity_rad_s() const noexcept {
  return gear_ratio_ * rotor_velocity_rad_s_;
}

double JointPlant::drive_torque_Nm() const noexcept { return Sum(drive_, sample_); }

double JointPlant::stored_energy_J() const noexcept {
  if (!has_play()) return 0.0;  // the rotor is part of the added inertia
  const double depth =
      std::max(0.0, std::abs(rotor_position_rad_ - sample_.position_rad) - 0.5 * play_rad_);
  return 0.5 * rotor_inertia_kg_m2_ * rotor_velocity_rad_s_ * rotor_velocity_rad_s_ +
         0.5 * contact_stiffness_Nm_rad_ * depth * depth;
}

}  // namespace sinew::plant
