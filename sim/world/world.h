// The simulated robot as a state provider's plant: a chain in Bullet, one actuator plant and at
// most one pneumatic element per joint, sensors.
//
// A cycle is cut into equal steps of at most substep_s. A step is drift - kick - drift:
//
//     q += dt/2 v;  (a0, A) from the chain at q, v;  (tau, R, F) from the plants
//     v_free = v + dt (1 + A R)^-1 (a0 + A tau);  v = v_free + W p,  W = (1 + A R)^-1 A,  |p| <= dt
//     F q += dt/2 v
//
// tau: torques on the links, R: inertia that the plants add (diagonal), F: friction bounds. URDF
// limits are hard stops without rebound. Two worlds of one configuration give bit-identical
// results.
//
// Where a model has link_inertia, inertia or gravity terms, they stand for the URDF's
// (OverrideLink).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/provider/simulated_plant.h"
#include "sim/plant/gas_effects.h"
#include "sim/plant/joint_plant.h"
#include "sim/plant/pneumatics.h"
#include "sim/world/chain.h"

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

struct WorldConfig {
  arm::Chain chain;
  actuator::RobotModel model;            // a joint for every moving joint of the chain, by name
  std::vector<WorldJointConfig> joints;  // as model.joints; empty: defaults
  double substep_s = 1e-4;
};

class World final : public provider::SimulatedPlant {
 public:
  // Throws std::invalid_argument naming the joint: no model for it, no such joint, impossible
  // values.
  explicit World(const WorldConfig& config);

  int joint_count() const override { return static_cast<int>(joints_.size()); }
  bool prismatic(int joint) const override;
  std::uint32_t measured_flags() const override { return measured_flags_; }
  void Reset(provider::PlantSensors* sensors) override;
  // Forces and payloads that are not finite count as 0, payloads below 0 as 0.
  void Disturb(const provider::Disturbance& disturbance) override { disturbance_ = disturbance; }
  // Pressures that are not finite are not imposed, nor those of joints without pneumatics; the
  // lowest is a vacuum.
  void ImposePressure(const provider::ImposedPressure& pressure) override { imposed_ = pressure; }
  const provider::GearTruth& gear_truth() const override { return truth_; }
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;

  // Following a recording: puts one joint where it says, at its velocity, the rotor within the play
  // of motor_position_rad (shaft), the terms' memory as given (actuator::JointModel's order).
  void Start(int index, const effects::JointSample& x, std::span<const double> memory);
  // From now on pressure, load force, payload, temperature and valve of the joint are those of x
  // (JointPlant::SetSurroundings) instead of the command's and the pneumatics'.
  void SetSurroundings(int index, const effects::JointSample& x);

  // Truth, for tests and experiments.
  double position_rad(int joint) const { return position_[joint]; }
  double velocity_rad_s(int joint) const { return velocity_[joint]; }
  const plant::JointPlant& plant(int joint) const {
    return joints_[static_cast<std::size_t>(joint)].plant;
  }

 private:
  struct Joint {
    plant::JointPlant plant;
    plant::PneumaticElement pneumatics;
    WorldJointConfig config;
    bool prismatic = false, current_drive = true;
    double lower = 0.0, upper = 0.0;
    plant::GasEffects gas;
    plant::Relays relays;
    double load_force_N = 0.0;
    bool follows = false;  // a recording's surroundings
    bool pressure_imposed = false;
    double imposed_pressure_bar = 0.0;
  };

  void Substep(double dt_s) noexcept;
  // Of one joint, dt_s long, after its motion.
  void StepPneumatics(Joint* joint, Eigen::Index index, double dt_s) noexcept;
  void ReadSensors(provider::PlantSensors* sensors);

  RigidChain chain_;
  double substep_s_;
  std::vector<Joint> joints_;     // in the order of the model
  std::vector<int> chain_joint_;  // index in the chain of each joint
  std::uint32_t measured_flags_ = 0;
  provider::Disturbance disturbance_;
  provider::ImposedPressure imposed_;
  provider::GearTruth truth_;
  JointVector position_, velocity_;  // in the order of the model
  // Work space of a step, in the order of the chain.
  JointVector chain_position_, chain_velocity_, acceleration_, torque_, added_, lower_, upper_,
      impulse_;
  JointMatrix inverse_, mixed_;
};

}  // namespace sinew::world
