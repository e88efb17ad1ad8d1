#include "sim/world/world.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/types/control_mode.h"
#include "components/types/run.h"
#include "sim/plant/friction.h"

namespace sinew::world {

namespace {

arm::Chain WithModelsLinks(arm::Chain chain, const actuator::RobotModel& model) {
  for (const actuator::JointModel& joint : model.joints) {
    const int body = arm::FindJoint(chain, joint.name);
    if (body < 0) {
      std::string known;
      for (const arm::Body& other : chain.bodies) {
        if (other.moves) known += (known.empty() ? "" : ", ") + other.joint_name;
      }
      throw std::invalid_argument("the model's joint '" + joint.name +
                                  "' is not in the URDF, which has: " + known);
    }
    const bool prismatic = chain.bodies[static_cast<std::size_t>(body)].prismatic;
    if (prismatic != (joint.kind == types::JointKind::kLinear)) {
      throw std::invalid_argument("joint '" + joint.name + "' is " +
                                  (prismatic ? "prismatic" : "revolute") +
                                  " in the URDF, but not in the model");
    }
    const bool has_gravity = joint.Find("gravity") >= 0;
    const bool has_inertia = joint.Find("link_inertia") >= 0 || joint.Find("inertia") >= 0;
    if (!has_gravity && !has_inertia) continue;
    const double inertia = plant::JointPlant::LinkInertia(joint);
    if (has_inertia && !(inertia > 0.0)) {
      throw std::invalid_argument("joint '" + joint.name + "': the model's inertia is " +
                                  std::to_string(inertia) + ", expected above 0");
    }
    arm::OverrideLink(chain, body, has_inertia ? inertia : 0.0, has_gravity);
  }
  for (const arm::Body& body : chain.bodies) {
    if (!body.moves) continue;
    bool found = false;
    for (const actuator::JointModel& joint : model.joints) found |= joint.name == body.joint_name;
    if (!found) {
      throw std::invalid_argument("the URDF's joint '" + body.joint_name +
                                  "' has no model, expected one of that name");
    }
  }
  return chain;
}

double ParameterOr(const actuator::JointModel& model, const char* effect, const char* parameter,
                   double fallback) {
  return model.Find(effect) >= 0 ? model.Parameter(effect, parameter) : fallback;
}

plant::PneumaticConfig WithModelsSlopes(plant::PneumaticConfig config,
                                        const actuator::JointModel& model) {
  config.torque_slope_Nm_bar = ParameterOr(model, "pneumatic_torque", "pneumatic_torque", 0.0);
  config.stiffness_slope_Nm_rad_bar =
      ParameterOr(model, "pneumatic_stiffness", "pneumatic_stiffness", 0.0);
  config.rest_angle_rad = ParameterOr(model, "pneumatic_stiffness", "rest_angle", 0.0);
  return config;
}

double Quantised(double angle_rad, double counts) {
  if (!(counts > 0.0)) return angle_rad;
  const double step = 2.0 * M_PI / counts;
  return step * std::round(angle_rad / step);
}

}  // namespace

World::World(const WorldConfig& config)
    : chain_(WithModelsLinks(config.chain, config.model)), substep_s_(config.substep_s) {
  if (!(substep_s_ > 0.0) || !std::isfinite(substep_s_)) {
    throw std::invalid_argument("substep_s = " + std::to_string(substep_s_));
  }
  if (!config.joints.empty() && config.joints.size() != config.model.joints.size()) {
    throw std::invalid_argument("as many joint configurations as joints of the model are needed");
  }
  const int n = chain_.joint_count();
  for (std::size_t j = 0; j < config.model.joints.size(); ++j) {
    const actuator::JointModel& model = config.model.joints[j];
    WorldJointConfig settings = config.joints.empty() ? WorldJointConfig{} : config.joints[j];
    settings.plant.link_inertia_in_body = true;
    settings.pneumatics = WithModelsSlopes(settings.pneumatics, model);
    const int body = arm::FindJoint(config.chain, model.name);
    const arm::Body& described = config.chain.bodies[static_cast<std::size_t>(body)];
    Joint joint{.plant = plant::JointPlant(model, settings.plant),
                .pneumatics = plant::PneumaticElement(settings.pneumatics),
                .config = settings,
                .prismatic = described.prismatic,
                .current_drive = model.Find("drive_voltage") < 0,
                .lower = described.lower,
                .upper = described.upper,
                .gas = plant::GasEffects(model),
                .relays = {}};
    if (!(settings.position_rad >= joint.lower && settings.position_rad <= joint.upper)) {
      throw std::invalid_argument("joint '" + model.name + "' starts at " +
                                  std::to_string(settings.position_rad) +
                                  ", outside the URDF's limits");
    }
    for (int k = 0; k < n; ++k) {
      if (chain_.joint_bodies()[static_cast<std::size_t>(k)] == body) chain_joint_.push_back(k);
    }
    joints_.push_back(std::move(joint));
  }
  for (JointVector* vector : {&position_, &velocity_, &chain_position_, &chain_velocity_,
                              &acceleration_, &torque_, &added_, &lower_, &upper_, &impulse_}) {
    *vector = JointVector::Zero(n);
  }
  inverse_ = mixed_ = JointMatrix::Zero(n, n);

  using types::Signal;
  const auto measure = [&](Signal signal) { measured_flags_ |= types::SignalBit(signal); };
  measure(Signal::kPosition);
  measure(Signal::kVelocity);
  measure(Signal::kMotorPosition);
  measure(Signal::kMotorVelocity);
  measure(Signal::kLoadForce);
  measure(Signal::kPayload);
  measure(Signal::kTemperature);
  for (const Joint& joint : joints_) {
    measure(joint.current_drive ? Signal::kMotorCurrent : Signal::kDriveVoltage);
    if (!joint.config.has_pneumatics) continue;
    measure(Signal::kChamberPressure);
    measure(Signal::kReservoirPressure);
    measure(Signal::kValveOpen);
  }
  provider::PlantSensors sensors;
  Reset(&sensors);
}

bool World::prismatic(int joint) const {
  return joints_[static_cast<std::size_t>(joint)].prismatic;
}

void World::Reset(provider::PlantSensors* sensors) {
  disturbance_ = {};
  imposed_ = {};
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    position_[at] = joints_[j].config.position_rad;
    velocity_[at] = 0.0;
    chain_position_[chain_joint_[j]] = position_[at];
    chain_velocity_[chain_joint_[j]] = 0.0;
  }
  chain_.SetState(chain_position_, chain_velocity_);
  chain_.Solve(&acceleration_, &inverse_);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const int c = chain_joint_[j];
    joint.plant.Reset(joint.config.position_rad, 1.0 / inverse_(c, c));
    joint.plant.SetMotorTemperature(joint.config.plant.motor_temperature_degC);
    joint.plant.SetLoad(0.0, joint.config.declared_payload_kg);
    joint.pneumatics.Reset(joint.config.position_rad);
    if (joint.config.has_pneumatics) joint.plant.SetPressure(joint.pneumatics.pressure_bar(), 0.0);
    joint.relays = {};
    joint.gas.Reset();
    joint.load_force_N = 0.0;
    joint.follows = false;
  }
  ReadSensors(sensors);
}

void World::Start(int index, const effects::JointSample& x, std::span<const double> memory) {
  Joint& joint = joints_.at(static_cast<std::size_t>(index));
  position_[index] = x.position_rad;
  velocity_[index] = x.velocity_rad_s;
  for (Eigen::Index j = 0; j < position_.size(); ++j) {
    const int c = chain_joint_[static_cast<std::size_t>(j)];
    chain_position_[c] = position_[j];
    chain_velocity_[c] = velocity_[j];
  }
  chain_.SetState(chain_position_, chain_velocity_);
  chain_.Solve(&acceleration_, &inverse_);
  const int c = chain_joint_[static_cast<std::size_t>(index)];
  joint.plant.Reset(x.position_rad, 1.0 / inverse_(c, c));
  // Teeth that would overlap by an encoder's zero do not.
  const actuator::JointModel& model = joint.plant.model();
  const double ratio = model.constants.gear_ratio;
  const double play = 0.5 * model.backlash_rad;
  const double gap = std::clamp(x.motor_position_rad / ratio - x.position_rad, -play, play);
  joint.plant.SetRotor(ratio * (x.position_rad + gap), x.motor_velocity_rad_s);
  joint.plant.SetMemory(memory);
}

void World::SetSurroundings(int index, const effects::JointSample& x) {
  Joint& joint = joints_.at(static_cast<std::size_t>(index));
  joint.follows = true;
  joint.plant.SetSurroundings(x);
}

void World::Step(const provider::PlantCommand& command, double period_s,
                 provider::PlantSensors* sensors) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    plant::DriveCommand drive;
    drive.mode = command.mode[j];
    drive.motor_torque_Nm = command.motor_torque_Nm[j];
    drive.position_rad = command.position_rad[j];
    drive.velocity_rad_s = command.velocity_rad_s[j];
    joint.plant.SetCommand(drive);
    const double force_N = disturbance_.hand_force_N[j];
    const double payload_kg = disturbance_.extra_payload_kg[j];
    joint.load_force_N = std::isfinite(force_N) ? force_N : 0.0;
    const double extra = std::isfinite(payload_kg) ? std::max(0.0, payload_kg) : 0.0;
    if (!joint.follows) {
      joint.plant.SetLoad(joint.load_force_N, joint.config.declared_payload_kg + extra);
    }
    joint.relays = {.valve_open = command.valve_open[j],
                    .compressor_on = command.compressor_on[j],
                    .vent_open = command.vent_open[j]};
    const double imposed_bar = imposed_.chamber_pressure_bar[j];
    joint.pressure_imposed = imposed_.imposed[j] && std::isfinite(imposed_bar);
    joint.imposed_pressure_bar =
        joint.pressure_imposed ? std::max(imposed_bar, -plant::kAmbientPressure_bar) : 0.0;
  }
  const long steps = std::max(1L, std::lround(std::ceil(period_s / substep_s_ - 1e-9)));
  const double dt = period_s / static_cast<double>(steps);
  for (long k = 0; k < steps; ++k) Substep(dt);
  ReadSensors(sensors);
}

void World::Substep(double dt_s) noexcept {
  const Eigen::Index n = position_.size();
  for (Eigen::Index j = 0; j < n; ++j) {
    position_[j] += 0.5 * dt_s * velocity_[j];
    const int c = chain_joint_[static_cast<std::size_t>(j)];
    chain_position_[c] = position_[j];
    chain_velocity_[c] = velocity_[j];
  }
  chain_.SetState(chain_position_, chain_velocity_);
  chain_.Solve(&acceleration_, &inverse_);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < n; ++j) {
    Joint& joint = joints_[static_cast<std::size_t>(j)];
    const int c = chain_joint_[static_cast<std::size_t>(j)];
    const plant::LinkLoad load = joint.plant.Begin(position_[j], velocity_[j], dt_s);
    torque_[c] = load.torque_Nm;
    added_[c] = load.added_inertia_kg_m2;
    lower_[c] = position_[j] >= joint.upper ? -kInfinity : -dt_s * load.friction_Nm;
    upper_[c] = position_[j] <= joint.lower ? kInfinity : dt_s * load.friction_Nm;
  }
  if (n == 1) {
    const double share = 1.0 / (1.0 + inverse_(0, 0) * added_[0]);
    chain_velocity_[0] += dt_s * share * (acceleration_[0] + inverse_(0, 0) * torque_[0]);
    inverse_(0, 0) *= share;
  } else {
    mixed_.noalias() = inverse_ * added_.asDiagonal();
    mixed_.diagonal().array() += 1.0;
    const Eigen::PartialPivLU<JointMatrix> solver(mixed_);
    acceleration_.noalias() += inverse_ * torque_;
    chain_velocity_ += dt_s * solver.solve(acceleration_);
    mixed_ = solver.solve(inverse_);
    inverse_ = 0.5 * (mixed_ + mixed_.transpose());
  }
  const auto size = static_cast<std::size_t>(n);
  plant::ApplyImpulses({inverse_.data(), size * size}, {lower_.data(), size}, {upper_.data(), size},
                       {impulse_.data(), size}, {chain_velocity_.data(), size});
  for (Eigen::Index j = 0; j < n; ++j) {
    Joint& joint = joints_[static_cast<std::size_t>(j)];
    velocity_[j] = chain_velocity_[chain_joint_[static_cast<std::size_t>(j)]];
    position_[j] += 0.5 * dt_s * velocity_[j];
    joint.plant.End(position_[j], velocity_[j], dt_s);
    if (joint.config.has_pneumatics && !joint.follows) StepPneumatics(&joint, j, dt_s);
  }
}

void World::StepPneumatics(Joint* joint, Eigen::Index index, double dt_s) noexcept {
  plant::PneumaticElement& element = joint->pneumatics;
  const double position = position_[index];
  if (joint->pressure_imposed) {
    element.Impose(joint->imposed_pressure_bar, position);
  } else {
    plant::Relays relays = joint->relays;
    relays.valve_open = joint->gas.Valve(relays.valve_open, dt_s);
    const double volume = element.chamber_volume_m3(position);
    const double before = element.chamber_volume_m3(position - dt_s * velocity_[index]);
    const double extra =
        joint->gas.Rate_bar_s(element.pressure_bar(), element.pressure_rate_bar_s(),
                              (volume - before) / (dt_s * volume), relays.valve_open, dt_s);
    element.Step(relays, position, dt_s, extra);
  }
  joint->plant.SetPressure(element.pressure_bar(), element.pressure_rate_bar_s());
}

void World::ReadSensors(provider::PlantSensors* sensors) {
  *sensors = provider::PlantSensors{};
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    const auto at = static_cast<Eigen::Index>(j);
    const double reading = position_[at] + joint.plant.encoder_error_rad();
    sensors->position_rad[j] =
        joint.prismatic ? reading : Quantised(reading, joint.config.output_encoder_counts);
    sensors->velocity_rad_s[j] = velocity_[at];
    sensors->torque_Nm[j] = joint.plant.drive_torque_Nm();
    sensors->motor_position_rad[j] =
        Quantised(joint.plant.motor_position_rad(), joint.config.motor_encoder_counts);
    sensors->motor_velocity_rad_s[j] = joint.plant.motor_velocity_rad_s();
    (joint.current_drive ? sensors->motor_current_A[j] : sensors->drive_voltage_V[j]) =
        joint.plant.drive_input();
    sensors->motor_temperature_degC[j] = joint.plant.motor_temperature_degC();
    if (joint.config.has_pneumatics) {
      sensors->chamber_pressure_bar[j] = joint.pneumatics.pressure_bar();
      sensors->reservoir_pressure_bar[j] = joint.pneumatics.reservoir_pressure_bar();
      sensors->valve_open[j] = joint.relays.valve_open;
    }
    const double play = joint.plant.play_rad();
    const double gap =
        joint.plant.motor_position_rad() / joint.plant.model().constants.gear_ratio - position_[at];
    truth_.contact[j] = play > 0.0 && std::abs(gap) > 0.5 * play ? (gap > 0.0 ? 1 : -1) : 0;
    truth_.play_angle_rad[j] = gap + 0.5 * play;
    truth_.backlash_rad[j] = play;
    sensors->load_force_N[j] = joint.load_force_N;
    sensors->declared_payload_kg[j] = joint.config.declared_payload_kg;
    sensors->valid[j] = true;
    if (!std::isfinite(position_[at]) || !std::isfinite(velocity_[at])) {
      sensors->valid[j] = false;
      sensors->fault = true;
      sensors->message = "joint '" + joint.plant.model().name + "': the simulation diverged";
    }
  }
}

}  // namespace sinew::world
