// Parts of a simulated robot that belong to its joints and not to its base: an actuator plant and
// at most one pneumatic element in each, commands, disturbances of joints, and their sensors.
// The caller integrates the bodies. For every joint and step, after half a step of motion:
//
//     load = Begin(joint, q, v, dt)      torque, added inertia and bounds of the impulse on the
//     link End(joint, q', v', dt)             angle and velocity after the step
//
// Joints are in the order of the model; chain_joint gives their place among the free joints of the
// chain. Units: SI, a linear joint reads m for rad and N for Nm. Thread: one. Begin and End
// allocate nothing and do not throw.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "components/model/actuator/model.h"
#include "components/robot/provider/simulated_plant.h"
#include "sim/plant/gas_effects.h"
#include "sim/plant/joint_plant.h"
#include "sim/plant/pneumatics.h"

namespace sinew::world {

struct WorldJointConfig {
  double position_rad = 0.0;  // at the start, at rest
  double declared_payload_kg = 0.0;
  double motor_encoder_counts = 0.0;  // per motor turn; 0: exact
  double output_encoder_counts = 0.0;
  plant::JointPlantConfig plant;
  bool has_pneumatics = false;
  plant::PneumaticConfig pneumatics;  // slopes and rest angle are taken from the model
};

// On a joint's link during a step. Friction and the URDF's end stops are an impulse p of the joint,
// Nms, with lower <= p <= upper (plant::ApplyImpulses).
struct JointLoad {
  double torque_Nm = 0.0;  // without friction
  double added_inertia_kg_m2 = 0.0;
  double lower_Nms = 0.0, upper_Nms = 0.0;
};

// The impulse of a stop where a joint is at or beyond an end of its range: without limit, away from
// the end. Elsewhere the bounds stay.
void AddStops(double position_rad, double lower_rad, double upper_rad, JointLoad* load) noexcept;

// Does the model fit the chain: every joint of it is a free joint there, of the same kind, and
// every other free joint is passive (arm::Body::passive). Throws std::invalid_argument naming the
// joint.
void CheckModelOfChain(const arm::Chain& chain, const actuator::RobotModel& model);

class ActuatedJoints {
 public:
  // configs: as model.joints; empty: defaults. Throws std::invalid_argument naming the joint: what
  // CheckModelOfChain and JointPlant refuse, a start outside the URDF's limits, too many joints.
  ActuatedJoints(const arm::Chain& chain, const actuator::RobotModel& model,
                 const std::vector<WorldJointConfig>& configs);

  int count() const { return static_cast<int>(joints_.size()); }
  bool prismatic(int joint) const { return at(joint).prismatic; }
  const std::string& name(int joint) const { return at(joint).plant.model().name; }
  int chain_joint(int joint) const { return at(joint).chain_joint; }
  // Index of a joint of the model; -1: there is none of this name.
  int Find(const std::string& name) const noexcept;
  double start_position_rad(int joint) const { return at(joint).config.position_rad; }
  std::uint32_t measured_flags() const { return measured_flags_; }
  const plant::JointPlant& plant(int joint) const { return at(joint).plant; }

  // Every joint at rest at its start position, without command and disturbance.
  // body_inertia_kg_m2: of the bodies, as seen at each joint.
  void Reset(std::span<const double> body_inertia_kg_m2);
  // One joint at the angle and velocity of x, its rotor within the play of x.motor_position_rad
  // (shaft), the terms' memory as given (actuator::JointModel's order).
  void Start(int index, const effects::JointSample& x, double body_inertia_kg_m2,
             std::span<const double> memory);
  // From now on the joint's surroundings are those of x (JointPlant::SetSurroundings), until Reset.
  void SetSurroundings(int index, const effects::JointSample& x);

  // Both act from the next Command on. Forces and payloads that are not finite count as 0, payloads
  // below 0 as 0. Pressures that are not finite are not imposed, nor those of joints without
  // pneumatics; the lowest is a vacuum.
  void Disturb(const provider::Disturbance& disturbance) { disturbance_ = disturbance; }
  void ImposePressure(const provider::ImposedPressure& pressure) { imposed_ = pressure; }
  // This joint's drive has no torque from the next Command on; -1: none is lost.
  void LoseDrive(int joint) noexcept { lost_drive_ = joint; }
  // For the steps of one cycle.
  void Command(const provider::PlantCommand& command) noexcept;

  JointLoad Begin(int index, double position_rad, double velocity_rad_s, double dt_s) noexcept;
  void End(int index, double position_rad, double velocity_rad_s, double dt_s) noexcept;

  // Readings of one joint's sensors and the state of its gear. Current (or voltage) and torque are
  // the means over the cycle, as meters of that bandwidth read: within a cycle the set point stands
  // still, and a position loop's torque falls by what its rotor runs ahead of it. Sets `fault` and
  // `message` where angle or velocity is not finite.
  void Read(int index, double position_rad, double velocity_rad_s, provider::PlantSensors* sensors,
            provider::GearTruth* truth) const;

 private:
  struct Joint {
    plant::JointPlant plant;
    plant::PneumaticElement pneumatics;
    WorldJointConfig config;
    int chain_joint = 0;
    bool prismatic = false, current_drive = true;
    double lower = 0.0, upper = 0.0;
    plant::GasEffects gas;
    plant::Relays relays;
    double load_force_N = 0.0;
    bool follows = false;  // a recording's surroundings
    bool pressure_imposed = false;
    double imposed_pressure_bar = 0.0;
    // Means over the steps since the last command, of which there were so many.
    double mean_drive_input = 0.0, mean_drive_torque_Nm = 0.0;
    int steps = 0;
  };

  const Joint& at(int joint) const { return joints_[static_cast<std::size_t>(joint)]; }
  // dt_s long, after the motion.
  static void StepPneumatics(Joint* joint, double position_rad, double velocity_rad_s,
                             double dt_s) noexcept;

  std::vector<Joint> joints_;
  std::uint32_t measured_flags_ = 0;
  provider::Disturbance disturbance_;
  provider::ImposedPressure imposed_;
  int lost_drive_ = -1;
};

}  // namespace sinew::world
