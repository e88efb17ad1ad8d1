#include "components/robot/control/compensator.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sinew::control {
namespace {

// A linear parameter of a term, or the fallback where the model has no such term.
double Value(const actuator::JointModel& model, std::string_view effect, std::string_view parameter,
             double fallback = 0.0) {
  return model.Find(effect) < 0 ? fallback : model.Parameter(effect, parameter);
}

}  // namespace

double ShaftPerDriveInput(const actuator::JointModel& model) {
  const effects::JointConstants& c = model.constants;
  if (c.torque_constant_Nm_A > 0.0) return c.torque_constant_Nm_A;
  return c.force_constant_N_V > 0.0 ? c.force_constant_N_V : 1.0;
}

double ShaftPerOutput(const actuator::JointModel& model) {
  double output_per_input = 0.0;  // of the drive's own factor
  if (model.Find("drive_current") >= 0) {
    output_per_input = model.Parameter("drive_current", "efficiency") * model.constants.gear_ratio *
                       model.constants.torque_constant_Nm_A;
  } else if (model.Find("drive_voltage") >= 0) {
    output_per_input = model.Parameter("drive_voltage", "gain");
  }
  if (!(output_per_input > 0.0) || !std::isfinite(output_per_input)) {
    throw std::invalid_argument("model of joint '" + model.name +
                                "' has no drive_current or drive_voltage with a positive factor");
  }
  return ShaftPerDriveInput(model) / output_per_input;
}

Compensator::Compensator(const actuator::JointModel& model, const CompensatorConfig& config)
    : model_(model),
      config_(config),
      shaft_per_output_(ShaftPerOutput(model)),
      shaft_per_input_(ShaftPerDriveInput(model)) {
  for (const auto& [value, what] : {std::pair{config.smoothing_rad_s, "smoothing velocity"},
                                    {config.pressure_filter_Hz, "pressure filter"},
                                    {config.lead_s, "lead"}}) {
    if (!(value >= 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " is " + std::to_string(value) +
                                  ", expected a finite number of at least 0");
    }
  }
  if (config.kind == CompensatorKind::kRecorded) {
    const RecordedTorque& recorded = config.recorded;
    if (!(recorded.period_s > 0.0) || !std::isfinite(recorded.period_s)) {
      throw std::invalid_argument("period of the recorded torque is " +
                                  std::to_string(recorded.period_s) + " s, expected more than 0");
    }
    if (recorded.motor_torque_Nm.empty()) throw std::invalid_argument("recorded torque is empty");
    for (const double torque_Nm : recorded.motor_torque_Nm) {
      if (!std::isfinite(torque_Nm)) {
        throw std::invalid_argument("recorded torque holds a value that is not finite");
      }
    }
  }
  inertia_kg_m2_ = Value(model, "inertia", "inertia") +
                   Value(model, "rotor_inertia", "rotor_inertia") +
                   Value(model, "link_inertia", "link_inertia");
  viscous_Nm_s_rad_ = Value(model, "viscous", "viscous") + Value(model, "motor_viscous", "viscous");
  stiffness_Nm_rad_bar_ = Value(model, "pneumatic_stiffness", "pneumatic_stiffness");
  rest_angle_rad_ = Value(model, "pneumatic_stiffness", "rest_angle");
  pneumatic_Nm_bar_ = Value(model, "pneumatic_torque", "pneumatic_torque");
  load_share_ = Value(model, "load_force", "share");
  payload_share_ = Value(model, "declared_payload", "share");
  memory_.assign(static_cast<std::size_t>(model_.memory_size()), 0.0);
}

void Compensator::Reset() noexcept { started_ = false; }

effects::JointSample Compensator::Sample(const Point& reference,
                                         const MeasuredJointState& m) const noexcept {
  effects::JointSample x;
  const double ratio = model_.constants.gear_ratio;
  x.time_s = time_s_;
  x.position_rad = reference.position_rad;
  x.velocity_rad_s = reference.velocity_rad_s;
  x.acceleration_rad_s2 = reference.acceleration_rad_s2;
  x.motor_position_rad = m.actuator_valid ? m.motor_position_rad : ratio * reference.position_rad;
  x.motor_velocity_rad_s = ratio * reference.velocity_rad_s;
  x.motor_acceleration_rad_s2 = ratio * reference.acceleration_rad_s2;
  x.pressure_bar = pressure_bar_;
  x.pressure_rate_bar_s = pressure_rate_bar_s_;
  x.load_force_N = load_force_N_;
  x.payload_kg = m.payload_kg;
  x.temperature_degC = m.temperature_degC;
  x.valve_open = m.valve_open;
  return x;
}

double Compensator::Linear(const Point& reference, const MeasuredJointState& m) const noexcept {
  const double length_m = model_.constants.link_length_m;
  const double inertia = inertia_kg_m2_ + payload_share_ * m.payload_kg * length_m * length_m;
  const double output_Nm =
      inertia * reference.acceleration_rad_s2 + viscous_Nm_s_rad_ * reference.velocity_rad_s +
      stiffness_Nm_rad_bar_ * pressure_bar_ * (reference.position_rad - rest_angle_rad_) -
      pneumatic_Nm_bar_ * pressure_bar_ + load_share_ * load_force_N_ * length_m;
  return shaft_per_output_ * output_Nm;
}

double Compensator::Model(const Point& reference, const MeasuredJointState& m,
                          double period_s) noexcept {
  effects::JointSample x = Sample(reference, m);
  if (memory_.empty()) {
    // nothing to remember
  } else if (!started_) {
    model_.ResetMemory(x, memory_);
  } else {
    model_.Advance(x, period_s, memory_);
  }
  const double v = reference.velocity_rad_s;
  const double v_s = config_.smoothing_rad_s;
  if (std::abs(v) >= v_s) return shaft_per_input_ * model_.RequiredDriveInput(x, memory_);
  const auto at_velocity = [&](double velocity_rad_s) {
    effects::JointSample side = x;
    side.velocity_rad_s = velocity_rad_s;
    side.motor_velocity_rad_s = model_.constants.gear_ratio * velocity_rad_s;
    return model_.RequiredDriveInput(side, memory_);
  };
  const double share = 0.5 * (1.0 + v / v_s);
  return shaft_per_input_ * ((1.0 - share) * at_velocity(-v_s) + share * at_velocity(v_s));
}

double Compensator::Recorded() const noexcept {
  const std::vector<double>& torque_Nm = config_.recorded.motor_torque_Nm;
  const double last = static_cast<double>(torque_Nm.size() - 1);
  const double at = std::min(time_s_ / config_.recorded.period_s, last);
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, torque_Nm.size() - 1);
  const double share = at - static_cast<double>(before);
  return (1.0 - share) * torque_Nm[before] + share * torque_Nm[after];
}

double Compensator::Step(const Point& reference, const MeasuredJointState& m,
                         double period_s) noexcept {
  if (config_.kind == CompensatorKind::kNone) return 0.0;
  if (!started_) {
    time_s_ = 0.0;
    pressure_bar_ = m.pressure_bar;
    pressure_rate_bar_s_ = 0.0;
    load_force_N_ = m.load_force_N;
  } else {
    time_s_ += period_s;
    double share = 1.0;
    if (config_.pressure_filter_Hz > 0.0) {
      share = period_s / (period_s + 1.0 / (2.0 * std::numbers::pi * config_.pressure_filter_Hz));
    }
    const double step_bar = share * (m.pressure_bar - pressure_bar_);
    pressure_bar_ += step_bar;
    pressure_rate_bar_s_ += share * (step_bar / period_s - pressure_rate_bar_s_);
    load_force_N_ += share * (m.load_force_N - load_force_N_);
  }
  if (config_.kind == CompensatorKind::kRecorded) {
    started_ = true;
    return Recorded();
  }
  Point ahead = reference;
  ahead.position_rad += config_.lead_s * (reference.velocity_rad_s +
                                          0.5 * config_.lead_s * reference.acceleration_rad_s2);
  ahead.velocity_rad_s += config_.lead_s * reference.acceleration_rad_s2;
  const double torque_Nm =
      config_.kind == CompensatorKind::kLinear ? Linear(ahead, m) : Model(ahead, m, period_s);
  started_ = true;
  return torque_Nm;
}

}  // namespace sinew::control
