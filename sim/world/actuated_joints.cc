#include "sim/world/actuated_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/base/types/joints.h"
#include "components/base/types/run.h"

namespace sinew::world {

namespace {

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

void AddStops(double position_rad, double lower_rad, double upper_rad, JointLoad* load) noexcept {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (position_rad >= upper_rad) load->lower_Nms = -kInfinity;
  if (position_rad <= lower_rad) load->upper_Nms = kInfinity;
}

void CheckModelOfChain(const arm::Chain& chain, const actuator::RobotModel& model) {
  for (const actuator::JointModel& joint : model.joints) {
    const int body = arm::FindJoint(chain, joint.name);
    if (body < 0) {
      std::string known;
      for (const arm::Body& other : chain.bodies) {
        if (arm::IsFree(other)) known += (known.empty() ? "" : ", ") + other.joint_name;
      }
      throw std::invalid_argument("the model's joint '" + joint.name +
                                  "' is not in the URDF, which has: " + known);
    }
    const arm::Body& described = chain.bodies[static_cast<std::size_t>(body)];
    arm::RequireFree(described);
    if (described.prismatic != (joint.kind == types::JointKind::kPrismatic)) {
      throw std::invalid_argument("joint '" + joint.name + "' is " +
                                  (described.prismatic ? "prismatic" : "revolute") +
                                  " in the URDF, but not in the model");
    }
    if (described.passive) {
      throw std::invalid_argument("joint '" + joint.name +
                                  "' is passive in the URDF, but has a model");
    }
  }
  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsFree(body) || body.passive) continue;
    const bool found = std::any_of(
        model.joints.begin(), model.joints.end(),
        [&](const actuator::JointModel& joint) { return joint.name == body.joint_name; });
    if (!found) {
      throw std::invalid_argument("the URDF's joint '" + body.joint_name +
                                  "' has no model, expected one of that name");
    }
  }
}

ActuatedJoints::ActuatedJoints(const arm::Chain& chain, const actuator::RobotModel& model,
                               const std::vector<WorldJointConfig>& configs) {
  CheckModelOfChain(chain, model);
  if (model.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument("a model of " + std::to_string(model.joints.size()) +
                                " joints, expected at most " + std::to_string(types::kMaxJoints));
  }
  if (!configs.empty() && configs.size() != model.joints.size()) {
    throw std::invalid_argument("as many joint configurations as joints of the model are needed");
  }
  const std::vector<arm::Coordinate> coordinates = arm::CoordinatesOf(chain);
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const actuator::JointModel& of = model.joints[j];
    WorldJointConfig settings = configs.empty() ? WorldJointConfig{} : configs[j];
    settings.plant.link_inertia_in_body = true;
    settings.pneumatics = WithModelsSlopes(settings.pneumatics, of);
    const int body = arm::FindJoint(chain, of.name);
    const arm::Body& described = chain.bodies[static_cast<std::size_t>(body)];
    Joint joint{.plant = plant::JointPlant(of, settings.plant),
                .pneumatics = plant::PneumaticElement(settings.pneumatics),
                .config = settings,
                .chain_joint = coordinates[static_cast<std::size_t>(body)].joint,
                .prismatic = described.prismatic,
                .current_drive = of.Find("drive_voltage") < 0,
                .lower = described.lower,
                .upper = described.upper,
                .gas = plant::GasEffects(of),
                .relays = {}};
    if (!(settings.position_rad >= joint.lower && settings.position_rad <= joint.upper)) {
      throw std::invalid_argument("joint '" + of.name + "' starts at " +
                                  std::to_string(settings.position_rad) +
                                  ", outside the URDF's limits");
    }
    joints_.push_back(std::move(joint));
  }
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
}

void ActuatedJoints::Reset(std::span<const double> body_inertia_kg_m2) {
  disturbance_ = {};
  imposed_ = {};
  lost_drive_ = -1;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    joint.plant.Reset(joint.config.position_rad, body_inertia_kg_m2[j]);
    joint.plant.SetMotorTemperature(joint.config.plant.motor_temperature_degC);
    joint.plant.SetLoad(0.0, joint.config.declared_payload_kg);
    joint.pneumatics.Reset(joint.config.position_rad);
    if (joint.config.has_pneumatics) joint.plant.SetPressure(joint.pneumatics.pressure_bar(), 0.0);
    joint.relays = {};
    joint.steps = 0;
    joint.gas.Reset();
    joint.load_force_N = 0.0;
    joint.follows = false;
  }
}

void ActuatedJoints::Start(int index, const effects::JointSample& x, double body_inertia_kg_m2,
                           std::span<const double> memory) {
  Joint& joint = joints_[static_cast<std::size_t>(index)];
  joint.plant.Reset(x.position_rad, body_inertia_kg_m2);
  // Teeth that would overlap by an encoder's zero do not.
  const actuator::JointModel& model = joint.plant.model();
  const double ratio = model.constants.gear_ratio;
  const double play = 0.5 * model.backlash_rad;
  const double gap = std::clamp(x.motor_position_rad / ratio - x.position_rad, -play, play);
  joint.plant.SetRotor(ratio * (x.position_rad + gap), x.motor_velocity_rad_s);
  joint.plant.SetMemory(memory);
}

void ActuatedJoints::SetSurroundings(int index, const effects::JointSample& x) {
  Joint& joint = joints_.at(static_cast<std::size_t>(index));
  joint.follows = true;
  joint.plant.SetSurroundings(x);
}

int ActuatedJoints::Find(const std::string& name) const noexcept {
  const auto found = std::find_if(joints_.begin(), joints_.end(), [&name](const Joint& joint) {
    return joint.plant.model().name == name;
  });
  return found == joints_.end() ? -1 : static_cast<int>(found - joints_.begin());
}

void ActuatedJoints::Command(const provider::PlantCommand& command) noexcept {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    plant::DriveCommand drive;
    drive.mode = command.mode[j];
    drive.motor_torque_Nm = command.motor_torque_Nm[j];
    drive.position_rad = command.position_rad[j];
    drive.velocity_rad_s = command.velocity_rad_s[j];
    if (static_cast<int>(j) == lost_drive_) drive = {};
    joint.plant.SetCommand(drive);
    joint.steps = 0;
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
}

JointLoad ActuatedJoints::Begin(int index, double position_rad, double velocity_rad_s,
                                double dt_s) noexcept {
  Joint& joint = joints_[static_cast<std::size_t>(index)];
  const plant::LinkLoad load = joint.plant.Begin(position_rad, velocity_rad_s, dt_s);
  JointLoad out{.torque_Nm = load.torque_Nm,
                .added_inertia_kg_m2 = load.added_inertia_kg_m2,
                .lower_Nms = -dt_s * load.friction_Nm,
                .upper_Nms = dt_s * load.friction_Nm};
  AddStops(position_rad, joint.lower, joint.upper, &out);
  return out;
}

void ActuatedJoints::End(int index, double position_rad, double velocity_rad_s,
                         double dt_s) noexcept {
  Joint& joint = joints_[static_cast<std::size_t>(index)];
  joint.plant.End(position_rad, velocity_rad_s, dt_s);
  if (joint.steps == 0) joint.mean_drive_input = joint.mean_drive_torque_Nm = 0.0;
  ++joint.steps;  // equal values have that mean to the bit
  joint.mean_drive_input += (joint.plant.drive_input() - joint.mean_drive_input) / joint.steps;
  joint.mean_drive_torque_Nm +=
      (joint.plant.drive_torque_Nm() - joint.mean_drive_torque_Nm) / joint.steps;
  if (joint.config.has_pneumatics && !joint.follows) {
    StepPneumatics(&joint, position_rad, velocity_rad_s, dt_s);
  }
}

void ActuatedJoints::StepPneumatics(Joint* joint, double position_rad, double velocity_rad_s,
                                    double dt_s) noexcept {
  plant::PneumaticElement& element = joint->pneumatics;
  if (joint->pressure_imposed) {
    element.Impose(joint->imposed_pressure_bar, position_rad);
  } else {
    plant::Relays relays = joint->relays;
    relays.valve_open = joint->gas.Valve(relays.valve_open, dt_s);
    const double volume = element.chamber_volume_m3(position_rad);
    const double before = element.chamber_volume_m3(position_rad - dt_s * velocity_rad_s);
    const double extra =
        joint->gas.Rate_bar_s(element.pressure_bar(), element.pressure_rate_bar_s(),
                              (volume - before) / (dt_s * volume), relays.valve_open, dt_s);
    element.Step(relays, position_rad, dt_s, extra);
  }
  joint->plant.SetPressure(element.pressure_bar(), element.pressure_rate_bar_s());
}

void ActuatedJoints::Read(int index, double position_rad, double velocity_rad_s,
                          provider::PlantSensors* sensors, provider::GearTruth* truth) const {
  const auto j = static_cast<std::size_t>(index);
  const Joint& joint = joints_[j];
  const double reading = position_rad + joint.plant.encoder_error_rad();
  sensors->position_rad[j] =
      joint.prismatic ? reading : Quantised(reading, joint.config.output_encoder_counts);
  sensors->velocity_rad_s[j] = velocity_rad_s;
  const bool moved = joint.steps > 0;
  sensors->torque_Nm[j] = moved ? joint.mean_drive_torque_Nm : joint.plant.drive_torque_Nm();
  sensors->motor_position_rad[j] =
      Quantised(joint.plant.motor_position_rad(), joint.config.motor_encoder_counts);
  sensors->motor_velocity_rad_s[j] = joint.plant.motor_velocity_rad_s();
  (joint.current_drive ? sensors->motor_current_A[j] : sensors->drive_voltage_V[j]) =
      moved ? joint.mean_drive_input : joint.plant.drive_input();
  sensors->motor_temperature_degC[j] = joint.plant.motor_temperature_degC();
  if (joint.config.has_pneumatics) {
    sensors->chamber_pressure_bar[j] = joint.pneumatics.pressure_bar();
    sensors->reservoir_pressure_bar[j] = joint.pneumatics.reservoir_pressure_bar();
    sensors->valve_open[j] = joint.relays.valve_open;
  }
  const double play = joint.plant.play_rad();
  const double gap =
      joint.plant.motor_position_rad() / joint.plant.model().constants.gear_ratio - position_rad;
  truth->contact[j] = play > 0.0 && std::abs(gap) > 0.5 * play ? (gap > 0.0 ? 1 : -1) : 0;
  truth->play_angle_rad[j] = gap + 0.5 * play;
  truth->backlash_rad[j] = play;
  sensors->load_force_N[j] = joint.load_force_N;
  sensors->declared_payload_kg[j] = joint.config.declared_payload_kg;
  sensors->valid[j] = true;
  if (!std::isfinite(position_rad) || !std::isfinite(velocity_rad_s)) {
    sensors->valid[j] = false;
    sensors->fault = true;
    sensors->message = "joint '" + joint.plant.model().name + "': the simulation diverged";
  }
}

}  // namespace sinew::world
