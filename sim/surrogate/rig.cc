#include "sim/surrogate/rig.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace sinew::surrogate {
namespace {

// Streams of the seed. Their numbers are part of the recordings: never reuse one.
enum Stream : std::uint64_t {
  kStreamMotorEncoder = 1,
  kStreamOutputEncoder,
  kStreamRowMotor,
  kStreamRowOutput,
  kStreamCurrent,
  kStreamPressure,
  kStreamReservoir,
  kStreamLoadCell,
  kStreamTemperature,
  kStreamSpecimen = 100,
};

constexpr double kPaPerBar = 1e5;
constexpr double kPowerBlend_W = 0.02;
// A flexible link: this much of it is the outer part; damper of its spring over the spring.
constexpr double kOuterShare = 0.6;
constexpr double kOuterDamping_s = 4e-3;
constexpr double kLongestMemory_s = 0.04;  // of late telegrams

// A spring and a damper that press against a side and never pull.
double Contact_Nm(double stiffness_Nm_rad, double damping_Nm_s_rad, double depth_rad,
                  double angle_rad, double velocity_rad_s) noexcept {
  const double side = angle_rad > 0.0 ? 1.0 : -1.0;
  return side *
         std::max(0.0, stiffness_Nm_rad * depth_rad + side * damping_Nm_s_rad * velocity_rad_s);
}

void FlowOut(Vessel* vessel, const Orifice& orifice, double open_s,
             const PneumaticParameters& air) noexcept {
  const double flow_kg_s = MassFlow_kg_s(orifice, vessel->pressure_Pa(), vessel->temperature_K(),
                                         air.atmosphere_Pa, air.wall_temperature_K);
  vessel->AddMass(-open_s * flow_kg_s, air.wall_temperature_K);
}

const RigParameters& Checked(const RigParameters& p) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(what);
  };
  require(p.rotor.inertia_kg_m2 > 0.0, "rotor inertia must be positive");
  require(p.link.inertia_kg_m2 > 0.0, "link inertia must be positive");
  require(p.rotor.viscous_Nm_s_rad >= 0.0 && p.link.viscous_Nm_s_rad >= 0.0,
          "viscous friction must not be negative");
  require(p.gear.ratio > 0.0, "gear ratio must be positive");
  require(p.gear.play_rad >= 0.0, "play must not be negative");
  require(p.gear.contact_stiffness_Nm_rad > 0.0 && p.gear.contact_damping_Nm_s_rad >= 0.0 &&
              p.gear.damping_depth_rad > 0.0,
          "tooth contact needs a positive stiffness and no negative damping");
  require(p.gear.share_drive > 0.0 && p.gear.share_drive <= 1.0 && p.gear.share_back > 0.0 &&
              p.gear.share_back <= 2.0,
          "share of the torque must be in (0, 1] driving and in (0, 2] driven back");
  require(p.gear.load_friction >= 0.0, "load friction must not be negative");
  require(p.link.length_m > 0.0, "link length must be positive");
  require(p.link.declared_payload_kg >= 0.0, "payload must not be negative");
  require(p.link.end_stop_rad > 0.0, "end stop must be positive");
  require(p.pneumatics.displacement_shape.size() >= 2,
          "displacement shape needs two values or more");
  for (const double share : p.pneumatics.displacement_shape) {
    require(std::isfinite(share), "displacement shape must be finite");
  }
  require(p.pneumatics.displacement_m3_rad >= 0.0, "displacement must not be negative");
  require(p.pneumatics.initial_pressure_bar > -0.9 && p.pneumatics.initial_pressure_bar <= 20.0,
          "initial pressure must be in (-0.9, 20] bar");
  require(p.sensors.encoder_counts > 0 && p.sensors.pressure_counts > 0, "counts must be positive");
  require(p.sensors.latch_phase >= 0.0 && p.sensors.latch_phase <= 1.0,
          "latch phase must be in [0, 1]");
  require(p.step_s > 0.0 && p.step_s <= 1e-4, "internal step must be at most 1e-4 s (10 kHz)");
  require(p.spread >= 0.0 && p.spread < 0.5, "spread must be in [0, 0.5)");
  require(std::abs(p.initial_angle_rad) <= p.link.end_stop_rad,
          "initial angle is beyond the end stop");
  // Stability of the explicit contact: angular frequency times step well below 2.
  const double inertia_output_kg_m2 = p.rotor.inertia_kg_m2 * p.gear.ratio * p.gear.ratio;
  const double reduced_kg_m2 = 1.0 / (1.0 / inertia_output_kg_m2 + 1.0 / p.link.inertia_kg_m2);
  require(std::sqrt(p.gear.contact_stiffness_Nm_rad / reduced_kg_m2) * p.step_s < 0.3,
          "tooth contact is too stiff for the internal step");
  require(p.gear.contact_damping_Nm_s_rad * p.step_s / reduced_kg_m2 < 0.5,
          "tooth contact is too damped for the internal step");
  return p;
}

}  // namespace

PneumaticLine LinePneumatics(const RigParameters& parameters) {
  // Least squares of the table over |q| <= 1 rad, where the rig works.
  const std::vector<double>& shape = parameters.pneumatics.displacement_shape;
  const double end_rad = parameters.link.end_stop_rad;
  double sum = 0.0, sum_q = 0.0, sum_q2 = 0.0, sum_a = 0.0, sum_qa = 0.0;
  for (int i = -100; i <= 100; ++i) {
    const double angle_rad = 0.01 * i;
    const double place =
        (angle_rad + end_rad) / (2.0 * end_rad) * static_cast<double>(shape.size() - 1);
    const int cell = std::clamp(static_cast<int>(place), 0, static_cast<int>(shape.size()) - 2);
    const double share = shape[cell] + (place - cell) * (shape[cell + 1] - shape[cell]);
    sum += 1.0;
    sum_q += angle_rad;
    sum_q2 += angle_rad * angle_rad;
    sum_a += share;
    sum_qa += angle_rad * share;
  }
  const double slope = (sum * sum_qa - sum_q * sum_a) / (sum * sum_q2 - sum_q * sum_q);
  const double scale_Nm_bar = parameters.pneumatics.displacement_m3_rad * kPaPerBar;
  return {scale_Nm_bar * (sum_a - slope * sum_q) / sum, -scale_Nm_bar * slope};
}

RigParameters Specimen(const RigParameters& parameters) {
  RigParameters p = parameters;
  if (p.spread <= 0.0) return p;
  RandomStream random(p.seed, kStreamSpecimen);
  const auto vary = [&](double* value) { *value *= 1.0 + random.Uniform(-p.spread, p.spread); };
  const double share_factor = 1.0 + random.Uniform(-p.spread, p.spread);
  p.gear.share_drive = std::min(1.0, p.gear.share_drive * share_factor);
  p.gear.share_back = std::min(2.0, p.gear.share_back * share_factor);
  vary(&p.rotor.inertia_kg_m2);
  vary(&p.rotor.viscous_Nm_s_rad);
  vary(&p.link.inertia_kg_m2);
  vary(&p.link.gravity_torque_Nm);
  vary(&p.link.friction.kinetic_Nm);
  vary(&p.link.friction.rest_growth_Nm);
  vary(&p.pneumatics.displacement_m3_rad);
  p.spread = 0.0;
  return p;
}

Rig::Rig(const RigParameters& parameters)
    : parameters_(Specimen(Checked(parameters))),
      motor_(parameters_.motor),
      drive_(parameters_.drive),
      rotor_friction_(parameters_.rotor.friction),
      output_friction_(parameters_.link.friction),
      undeclared_(parameters_.effects, parameters_.gear.ratio),
      chamber_(1e-6, parameters_.pneumatics.atmosphere_Pa,
               parameters_.pneumatics.wall_temperature_K, parameters_.pneumatics.chamber_wall_W_K),
      reservoir_(parameters_.pneumatics.reservoir_volume_m3, parameters_.pneumatics.atmosphere_Pa,
                 parameters_.pneumatics.wall_temperature_K,
                 parameters_.pneumatics.reservoir_wall_W_K),
      valve_relay_(parameters_.pneumatics.valve_relay),
      compressor_relay_(parameters_.pneumatics.compressor_relay),
      vent_relay_(parameters_.pneumatics.vent_relay),
      output_observer_(parameters_.sensors.output_observer_rad_s),
      sensor_step_s_(1.0 / parameters_.drive.rate_Hz),
      count_rad_(2.0 * std::numbers::pi / parameters_.sensors.encoder_counts) {
  const PneumaticParameters& air = parameters_.pneumatics;
  const std::size_t points = air.displacement_shape.size();
  table_step_rad_ = 2.0 * parameters_.link.end_stop_rad / static_cast<double>(points - 1);
  volume_table_m3_.resize(points);
  volume_table_m3_[0] = air.dead_volume_m3;
  for (std::size_t i = 1; i < points; ++i) {
    volume_table_m3_[i] =
        volume_table_m3_[i - 1] + 0.5 * table_step_rad_ * air.displacement_m3_rad *
                                      (air.displacement_shape[i - 1] + air.displacement_shape[i]);
    if (!(volume_table_m3_[i] > 0.0)) {
      throw std::invalid_argument("the displacement shape leaves the chamber no volume");
    }
  }
  for (const EffectSpec& effect : parameters_.effects) {
    if (effect.name == "transport_delay" && past_.empty()) {
      past_.resize(static_cast<std::size_t>(2.0 * kLongestMemory_s / parameters_.step_s));
    }
  }
  Reset();
}

void Rig::Reset() {
  time_s_ = 0.0;
  const std::uint64_t seed = parameters_.seed;
  motor_encoder_noise_ = RandomStream(seed, kStreamMotorEncoder);
  output_encoder_noise_ = RandomStream(seed, kStreamOutputEncoder);
  row_noise_motor_ = RandomStream(seed, kStreamRowMotor);
  row_noise_output_ = RandomStream(seed, kStreamRowOutput);
  current_noise_ = RandomStream(seed, kStreamCurrent);
  pressure_noise_ = RandomStream(seed, kStreamPressure);
  reservoir_noise_ = RandomStream(seed, kStreamReservoir);
  load_cell_noise_ = RandomStream(seed, kStreamLoadCell);
  temperature_noise_ = RandomStream(seed, kStreamTemperature);
  motor_.Reset();
  undeclared_.Reset();
  dry_share_ = viscous_share_ = 1.0;
  SetState(parameters_.initial_angle_rad * parameters_.gear.ratio, 0.0,
           parameters_.initial_angle_rad, 0.0);
  SetRest(parameters_.initial_rest_s);
  SetPressure(parameters_.pneumatics.initial_pressure_bar,
              parameters_.pneumatics.initial_pressure_bar);
  valve_command_ = parameters_.pneumatics.initial_valve_open;
  valve_relay_.Reset(valve_command_);
  compressor_relay_.Reset(false);
  vent_relay_.Reset(false);
  hand_force_N_ = 0.0;
  payload_kg_ = parameters_.link.declared_payload_kg + undeclared_.payload_kg();
}

void Rig::SetState(double motor_angle_rad, double motor_velocity_rad_s, double output_angle_rad,
                   double output_velocity_rad_s) noexcept {
  motor_rad_ = motor_angle_rad;
  motor_rad_s_ = motor_velocity_rad_s;
  output_rad_ = output_angle_rad;
  output_rad_s_ = output_velocity_rad_s;
  tip_rad_ = output_angle_rad;
  tip_rad_s_ = output_velocity_rad_s;
  std::fill(past_.begin(), past_.end(),
            Past{time_s_, motor_rad_, output_rad_, motor_velocity_rad_s, output_velocity_rad_s});
  rotor_friction_.Reset(0.0);
  output_friction_.Reset(0.0);
  drive_.Reset(motor_angle_rad);
  output_observer_.Reset(output_angle_rad);
  torque_reference_Nm_ = 0.0;
  until_sensor_s_ = 0.0;
  tooth_Nm_ = friction_Nm_ = pneumatic_Nm_ = undeclared_output_Nm_ = undeclared_rotor_Nm_ = 0.0;
  chamber_.SetVolume(ChamberVolume_m3(output_rad_));
}

void Rig::SetPressure(double chamber_bar, double reservoir_bar) noexcept {
  const PneumaticParameters& air = parameters_.pneumatics;
  chamber_.Reset(ChamberVolume_m3(output_rad_), air.atmosphere_Pa + chamber_bar * kPaPerBar,
                 air.wall_temperature_K);
  reservoir_.Reset(air.reservoir_volume_m3, air.atmosphere_Pa + reservoir_bar * kPaPerBar,
                   air.wall_temperature_K);
  lagged_gauge_Pa_ = chamber_bar * kPaPerBar;
}

void Rig::Wear(double dry_share, double viscous_share) noexcept {
  dry_share_ = std::max(0.0, dry_share);
  viscous_share_ = std::max(0.0, viscous_share);
}

void Rig::SetRest(double rest_s) noexcept {
  rotor_friction_.Reset(rest_s);
  output_friction_.Reset(rest_s);
}

double Rig::Displacement_m3_rad(double angle_rad) const noexcept {
  const std::vector<double>& shape = parameters_.pneumatics.displacement_shape;
  const double place = (angle_rad + parameters_.link.end_stop_rad) / table_step_rad_;
  const int last = static_cast<int>(shape.size()) - 2;
  const int cell = std::clamp(static_cast<int>(std::floor(place)), 0, last);
  const double x = std::clamp(place - cell, 0.0, 1.0);
  return parameters_.pneumatics.displacement_m3_rad *
         ((1.0 - x) * shape[cell] + x * shape[cell + 1]);
}

double Rig::ChamberVolume_m3(double angle_rad) const noexcept {
  const std::vector<double>& shape = parameters_.pneumatics.displacement_shape;
  const double place = (angle_rad + parameters_.link.end_stop_rad) / table_step_rad_;
  const int last = static_cast<int>(shape.size()) - 2;
  const int cell = std::clamp(static_cast<int>(std::floor(place)), 0, last);
  const double x = place - cell;
  const double inside = std::clamp(x, 0.0, 1.0);
  // Exact integral of Displacement_m3_rad, which is constant beyond the table.
  const double mean = shape[cell] + 0.5 * inside * (shape[cell + 1] - shape[cell]);
  double turned = inside * mean;
  if (x < 0.0) turned = x * shape[cell];
  if (x > 1.0) turned += (x - 1.0) * shape[cell + 1];
  const double volume_m3 = volume_table_m3_[cell] +
                           parameters_.pneumatics.displacement_m3_rad * table_step_rad_ * turned;
  return std::max(volume_m3, 0.2 * parameters_.pneumatics.dead_volume_m3);
}

double Rig::Count_rad(double angle_rad) const noexcept {
  return std::floor(angle_rad / count_rad_ + 0.5) * count_rad_;
}

Rig::Past Rig::Now() const noexcept {
  return {time_s_, motor_rad_, output_rad_, drive_.velocity_estimate_rad_s(),
          output_observer_.velocity_rad_s()};
}

Rig::Past Rig::Seen() const noexcept {
  const double late_s = undeclared_.size(Effect::kTransportDelay);
  if (!(late_s > 0.0) || past_.empty()) return Now();
  for (std::size_t back = 1; back <= past_.size(); ++back) {
    const Past& then = past_[(past_next_ + past_.size() - back) % past_.size()];
    if (then.time_s <= time_s_ - late_s) return then;
  }
  return past_[past_next_];
}

double Rig::Play_rad() const noexcept {
  return std::max(0.0, parameters_.gear.play_rad + undeclared_.size(Effect::kBacklashWidth));
}

void Rig::Advance(const RigInput& input, double duration_s) noexcept {
  if (!(duration_s > 0.0)) return;
  const int steps =
      std::max(1, static_cast<int>(std::ceil(duration_s / parameters_.step_s - 1e-6)));
  const double dt_s = duration_s / steps;
  hand_force_N_ = input.hand_force_N;
  valve_command_ = input.valve_open;
  for (int i = 0; i < steps; ++i) Substep(input, dt_s);
}

void Rig::Substep(const RigInput& input, double dt_s) noexcept {
  undeclared_.SetTime(time_s_);
  payload_kg_ =
      parameters_.link.declared_payload_kg + input.extra_payload_kg + undeclared_.payload_kg();
  const double air_gap_Nm = StepDrive_Nm(input.drive, dt_s);
  Drift(0.5 * dt_s);
  undeclared_.MoveMagnet(output_rad_s_, dt_s);
  MoveAir(input, dt_s);
  SetTorques(dt_s);
  KickOutput(dt_s);
  KickRotor(air_gap_Nm, dt_s);
  Drift(0.5 * dt_s);
  time_s_ += dt_s;
  if (past_.empty()) return;
  past_[past_next_] = Now();
  past_next_ = (past_next_ + 1) % past_.size();
}

// The torque of the air gap. The drive's electronics work at their own rate.
double Rig::StepDrive_Nm(const DriveCommand& command, double dt_s) noexcept {
  const SensorParameters& s = parameters_.sensors;
  until_sensor_s_ -= dt_s;
  if (until_sensor_s_ <= 0.0) {
    until_sensor_s_ += sensor_step_s_;
    const double motor_rad =
        Count_rad(motor_rad_ + s.motor_encoder_noise_rad * motor_encoder_noise_.Gaussian());
    torque_reference_Nm_ = drive_.Step(command, motor_rad, sensor_step_s_);
    const double output_rad =
        Count_rad(undeclared_.OutputEncoder_rad(output_rad_) +
                  s.output_encoder_noise_rad * output_encoder_noise_.Gaussian());
    output_observer_.Step(output_rad, sensor_step_s_);
  }
  // The current loop controls the reading: the windings get the error with opposite sign.
  motor_.SetSupply(undeclared_.SupplyShare());
  const double asked_Nm = torque_reference_Nm_ - parameters_.motor.torque_constant_Nm_A *
                                                     undeclared_.size(Effect::kCurrentOffset);
  const double by_current_Nm = motor_.Step(asked_Nm, motor_rad_, motor_rad_s_, dt_s);
  return by_current_Nm * undeclared_.TorqueShare(motor_.iq_A());
}

void Rig::Drift(double duration_s) noexcept {
  output_rad_ += duration_s * output_rad_s_;
  motor_rad_ += duration_s * motor_rad_s_;
  chamber_.SetVolume(ChamberVolume_m3(output_rad_));
}

void Rig::MoveAir(const RigInput& input, double dt_s) noexcept {
  const PneumaticParameters& air = parameters_.pneumatics;
  const double opening =
      valve_relay_.Step(input.valve_open, dt_s, undeclared_.size(Effect::kValveDeadTime));
  const double compressor = compressor_relay_.Step(input.compressor_on, dt_s);
  const double vent = vent_relay_.Step(input.vent_open, dt_s);
  if (opening > 0.0) {
    const double moved_kg =
        dt_s * opening *
        MassFlow_kg_s(air.valve, reservoir_.pressure_Pa(), reservoir_.temperature_K(),
                      chamber_.pressure_Pa(), chamber_.temperature_K());
    const double from_chamber_K = chamber_.temperature_K();
    chamber_.AddMass(moved_kg, reservoir_.temperature_K());
    reservoir_.AddMass(-moved_kg, from_chamber_K);
  }
  const Orifice seal_leak{air.seal_leak.conductance_m3_sPa + undeclared_.size(Effect::kLeak),
                          air.seal_leak.critical_ratio};
  if (seal_leak.conductance_m3_sPa > 0.0) FlowOut(&chamber_, seal_leak, dt_s, air);
  if (vent > 0.0) FlowOut(&reservoir_, air.vent, dt_s * vent, air);
  if (compressor > 0.0) {
    const double gauge_bar = (reservoir_.pressure_Pa() - air.atmosphere_Pa) / kPaPerBar;
    const double share = std::clamp(1.0 - gauge_bar / air.compressor_limit_bar, 0.0, 1.0);
    reservoir_.AddMass(dt_s * compressor * share * air.compressor_kg_s, air.wall_temperature_K);
  }
  chamber_.ExchangeHeat(air.wall_temperature_K, dt_s, undeclared_.size(Effect::kGasHeatExchange));
  reservoir_.ExchangeHeat(air.wall_temperature_K, dt_s);
  if (input.pressure_imposed) {
    chamber_.Reset(chamber_.volume_m3(), air.atmosphere_Pa + input.imposed_pressure_bar * kPaPerBar,
                   air.wall_temperature_K);
  }
  const double lag_s = undeclared_.size(Effect::kPressureLag);
  lagged_gauge_Pa_ += (chamber_.pressure_Pa() - air.atmosphere_Pa - lagged_gauge_Pa_) *
                      (lag_s > 0.0 ? dt_s / (lag_s + dt_s) : 1.0);
}

// The torques of the present motion.
void Rig::SetTorques(double dt_s) noexcept {
  const double gauge_Pa = chamber_.pressure_Pa() - parameters_.pneumatics.atmosphere_Pa;
  const double gauge_bar = gauge_Pa / kPaPerBar;
  pneumatic_Nm_ =
      gauge_Pa * Displacement_m3_rad(output_rad_) * undeclared_.PneumaticShare(gauge_bar);
  tooth_Nm_ = Tooth_Nm();
  const EffectState state{motor_rad_, motor_rad_s_, output_rad_s_,
                          gauge_bar,  output_rad_,  motor_.temperature_degC()};
  const double extra_Nm = undeclared_.ExtraFriction_Nm(state);
  const double kinetic_Nm = parameters_.link.friction.kinetic_Nm;
  const double scale = kinetic_Nm > 0.0 ? std::max(0.05, 1.0 + extra_Nm / kinetic_Nm) : 1.0;
  friction_Nm_ = output_friction_.Step(output_rad_s_, dt_s, dry_share_ * scale);
  undeclared_output_Nm_ = undeclared_.OutputTorque_Nm(state, dt_s);
  undeclared_rotor_Nm_ = undeclared_.RotorTorque_Nm(state);
}

double Rig::Tooth_Nm() const noexcept {
  const GearParameters& gear = parameters_.gear;
  const double twist_rad = motor_rad_ / gear.ratio - output_rad_;
  const double twist_rad_s = motor_rad_s_ / gear.ratio - output_rad_s_;
  const double depth_rad = std::abs(twist_rad) - 0.5 * Play_rad();
  if (!(depth_rad > 0.0)) return 0.0;
  // Shafts in series with the teeth take the same share off spring and damper.
  const double stiff =
      1.0 / (1.0 + gear.contact_stiffness_Nm_rad * undeclared_.size(Effect::kGearCompliance));
  const double damping_Nm_s_rad =
      stiff * gear.contact_damping_Nm_s_rad * depth_rad / (depth_rad + gear.damping_depth_rad);
  return Contact_Nm(stiff * gear.contact_stiffness_Nm_rad, damping_Nm_s_rad, depth_rad, twist_rad,
                    twist_rad_s);
}

void Rig::KickOutput(double dt_s) noexcept {
  const LinkParameters& link = parameters_.link;
  const double arm_kg_m = payload_kg_ * link.length_m;
  const double pushed_Nm = (hand_force_N_ + undeclared_.Bump_N()) * link.length_m;
  const double tilt_rad = undeclared_.Tilt_rad();
  double output_Nm = tooth_Nm_ + friction_Nm_ + undeclared_output_Nm_ + pneumatic_Nm_;
  double inertia_kg_m2 = link.inertia_kg_m2 + undeclared_.size(Effect::kLinkInertia);
  const double compliance_rad_Nm = undeclared_.size(Effect::kFlexibleLink);
  if (compliance_rad_Nm > 0.0) {
    // The outer part, the payload and the hand hang on a spring.
    const double outer_kg_m2 = kOuterShare * link.inertia_kg_m2 + arm_kg_m * link.length_m;
    inertia_kg_m2 -= kOuterShare * link.inertia_kg_m2;
    tip_rad_ += 0.5 * dt_s * tip_rad_s_;
    const double bent_Nm =
        (tip_rad_ - output_rad_ + kOuterDamping_s * (tip_rad_s_ - output_rad_s_)) /
        compliance_rad_Nm;
    const double outer_Nm = -bent_Nm - pushed_Nm -
                            (kOuterShare * link.gravity_torque_Nm + arm_kg_m * link.gravity_m_s2) *
                                std::cos(tip_rad_ + tilt_rad);
    tip_rad_s_ += dt_s * outer_Nm / outer_kg_m2;
    tip_rad_ += 0.5 * dt_s * tip_rad_s_;
    output_Nm +=
        bent_Nm - (1.0 - kOuterShare) * link.gravity_torque_Nm * std::cos(output_rad_ + tilt_rad);
  } else {
    output_Nm =
        output_Nm - pushed_Nm -
        (link.gravity_torque_Nm + arm_kg_m * link.gravity_m_s2) * std::cos(output_rad_ + tilt_rad);
    inertia_kg_m2 += arm_kg_m * link.length_m;
    tip_rad_ = output_rad_;
    tip_rad_s_ = output_rad_s_;
  }
  const double beyond_rad = std::abs(output_rad_) - link.end_stop_rad;
  if (beyond_rad > 0.0) {
    output_Nm -= Contact_Nm(link.end_stop_stiffness_Nm_rad, link.end_stop_damping_Nm_s_rad,
                            beyond_rad, output_rad_, output_rad_s_);
  }
  output_rad_s_ = (output_rad_s_ + dt_s * output_Nm / inertia_kg_m2) /
                  (1.0 + dt_s * link.viscous_Nm_s_rad / inertia_kg_m2);
}

void Rig::KickRotor(double air_gap_Nm, double dt_s) noexcept {
  if (parameters_.rotor_locked) {
    motor_rad_s_ = 0.0;
    return;
  }
  const GearParameters& gear = parameters_.gear;
  const RotorParameters& rotor = parameters_.rotor;
  double share = gear.share_drive;
  const double share_back =
      gear.share_back * (1.0 + undeclared_.size(Effect::kDriveEfficiencyDirection));
  if (share_back != gear.share_drive) {
    // The direction of power is blended around zero: no chatter at standstill.
    const double power_W = air_gap_Nm * motor_rad_s_;
    const double forward = 0.5 * (1.0 + std::tanh(power_W / kPowerBlend_W));
    share = forward * gear.share_drive + (1.0 - forward) * share_back;
  }
  double friction_scale = 1.0;
  const double load_friction =
      gear.load_friction + undeclared_.size(Effect::kLoadDependentFriction);
  if (load_friction > 0.0 && rotor.friction.kinetic_Nm > 0.0) {
    friction_scale += load_friction * std::abs(tooth_Nm_) / gear.ratio / rotor.friction.kinetic_Nm;
  }
  const double rotor_Nm = share * air_gap_Nm + undeclared_rotor_Nm_ - tooth_Nm_ / gear.ratio +
                          rotor_friction_.Step(motor_rad_s_, dt_s, friction_scale);
  motor_rad_s_ = (motor_rad_s_ + dt_s * rotor_Nm / rotor.inertia_kg_m2) /
                 (1.0 + dt_s * viscous_share_ * rotor.viscous_Nm_s_rad / rotor.inertia_kg_m2);
}

RigReading Rig::Read() noexcept {
  const SensorParameters& s = parameters_.sensors;
  const auto pressure_bar = [&](double true_bar, RandomStream* noise) {
    const double lsb_bar = s.pressure_range_bar / s.pressure_counts;
    const double gauge_bar = true_bar + s.pressure_noise_bar * noise->Gaussian();
    return std::clamp(std::floor(gauge_bar / lsb_bar + 0.5), 0.0, s.pressure_counts - 1.0) *
           lsb_bar;
  };
  const double atmosphere_Pa = parameters_.pneumatics.atmosphere_Pa;
  const double chamber_gauge_Pa = undeclared_.size(Effect::kPressureLag) > 0.0
                                      ? lagged_gauge_Pa_
                                      : chamber_.pressure_Pa() - atmosphere_Pa;
  const Past seen = Seen();
  RigReading reading;
  reading.motor_angle_rad =
      Count_rad(seen.motor_rad + s.motor_encoder_noise_rad * row_noise_motor_.Gaussian());
  reading.motor_velocity_rad_s = seen.motor_estimate_rad_s;
  reading.output_angle_rad = Count_rad(undeclared_.OutputEncoder_rad(seen.output_rad) +
                                       s.output_encoder_noise_rad * row_noise_output_.Gaussian());
  reading.output_velocity_rad_s = seen.output_estimate_rad_s;
  reading.motor_current_A = motor_.iq_A() + undeclared_.size(Effect::kCurrentOffset) +
                            s.current_noise_A * current_noise_.Gaussian();
  reading.output_torque_Nm = s.torque_efficiency * parameters_.gear.ratio *
                             parameters_.motor.torque_constant_Nm_A * reading.motor_current_A;
  reading.drive_voltage_V = motor_.vq_V();
  const double temperature_degC =
      motor_.temperature_degC() + s.temperature_noise_degC * temperature_noise_.Gaussian();
  reading.motor_temperature_degC =
      s.temperature_step_degC > 0.0
          ? std::floor(temperature_degC / s.temperature_step_degC + 0.5) * s.temperature_step_degC
          : temperature_degC;
  reading.chamber_pressure_bar =
      pressure_bar(chamber_gauge_Pa / kPaPerBar * (1.0 + undeclared_.size(Effect::kPressureGain)) +
                       undeclared_.size(Effect::kPressureOffset),
                   &pressure_noise_);
  reading.reservoir_pressure_bar =
      pressure_bar((reservoir_.pressure_Pa() - atmosphere_Pa) / kPaPerBar, &reservoir_noise_);
  reading.load_force_N = undeclared_.LoadCell_N(hand_force_N_, output_rad_) +
                         s.load_cell_noise_N * load_cell_noise_.Gaussian();
  reading.declared_payload_kg = parameters_.link.declared_payload_kg;
  reading.valve_open = valve_command_;
  return reading;
}

RigTruth Rig::truth() const noexcept {
  RigTruth t;
  t.time_s = time_s_;
  t.motor_angle_rad = motor_rad_;
  t.motor_velocity_rad_s = motor_rad_s_;
  t.output_angle_rad = output_rad_;
  t.output_velocity_rad_s = output_rad_s_;
  t.iq_A = motor_.iq_A();
  t.tooth_torque_Nm = tooth_Nm_;
  const double twist_rad = motor_rad_ / parameters_.gear.ratio - output_rad_;
  t.play_rad = Play_rad();
  if (std::abs(twist_rad) > 0.5 * t.play_rad) t.contact = twist_rad > 0.0 ? 1 : -1;
  t.friction_torque_Nm = friction_Nm_;
  t.yield_torque_Nm = output_friction_.yield_Nm();
  t.pneumatic_torque_Nm = pneumatic_Nm_;
  const double atmosphere_Pa = parameters_.pneumatics.atmosphere_Pa;
  t.chamber_pressure_bar = (chamber_.pressure_Pa() - atmosphere_Pa) / kPaPerBar;
  t.reservoir_pressure_bar = (reservoir_.pressure_Pa() - atmosphere_Pa) / kPaPerBar;
  t.chamber_volume_m3 = chamber_.volume_m3();
  t.chamber_mass_kg = chamber_.mass_kg();
  t.payload_kg = payload_kg_;
  return t;
}

RigEnergy Rig::Energy() const noexcept {
  const LinkParameters& link = parameters_.link;
  RigEnergy energy;
  const double arm_kg_m = payload_kg_ * link.length_m;
  energy.kinetic_J =
      0.5 * (link.inertia_kg_m2 + arm_kg_m * link.length_m) * output_rad_s_ * output_rad_s_ +
      0.5 * parameters_.rotor.inertia_kg_m2 * motor_rad_s_ * motor_rad_s_;
  energy.gravity_J =
      (link.gravity_torque_Nm + arm_kg_m * link.gravity_m_s2) * std::sin(output_rad_);
  const double depth_rad =
      std::max(0.0, std::abs(motor_rad_ / parameters_.gear.ratio - output_rad_) -
                        0.5 * parameters_.gear.play_rad);
  const double beyond_rad = std::max(0.0, std::abs(output_rad_) - link.end_stop_rad);
  energy.contact_J = 0.5 * parameters_.gear.contact_stiffness_Nm_rad * depth_rad * depth_rad +
                     0.5 * link.end_stop_stiffness_Nm_rad * beyond_rad * beyond_rad;
  energy.springs_J = output_friction_.spring_energy_J() + rotor_friction_.spring_energy_J();
  energy.gas_J = chamber_.energy_J() + parameters_.pneumatics.atmosphere_Pa * chamber_.volume_m3();
  return energy;
}

}  // namespace sinew::surrogate
