// The simulated robot on a fixed base as a state provider's plant: a chain in Bullet with actuated
// joints (actuated_joints.h).
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
#include <vector>

#include "components/model/actuator/model.h"
#include "components/robot/provider/simulated_plant.h"
#include "sim/world/actuated_joints.h"
#include "sim/world/chain.h"

namespace sinew::world {

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

  int joint_count() const override { return joints_.count(); }
  bool prismatic(int joint) const override { return joints_.prismatic(joint); }
  std::string joint_name(int joint) const override { return joints_.name(joint); }
  std::uint32_t measured_flags() const override { return joints_.measured_flags(); }
  void Reset(provider::PlantSensors* sensors) override;
  // Both: values that are not finite as in ActuatedJoints.
  void Disturb(const provider::Disturbance& disturbance) override { joints_.Disturb(disturbance); }
  void ImposePressure(const provider::ImposedPressure& pressure) override {
    joints_.ImposePressure(pressure);
  }
  const provider::GearTruth& gear_truth() const override { return truth_; }
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;

  // Following a recording: puts one joint where it says, at its velocity, the rotor within the play
  // of motor_position_rad (shaft), the terms' memory as given (actuator::JointModel's order).
  void Start(int index, const effects::JointSample& x, std::span<const double> memory);
  // From now on pressure, load force, payload, temperature and valve of the joint are those of x
  // (JointPlant::SetSurroundings) instead of the command's and the pneumatics'.
  void SetSurroundings(int index, const effects::JointSample& x) {
    joints_.SetSurroundings(index, x);
  }

  // Truth, for tests and experiments.
  double position_rad(int joint) const { return position_[joint]; }
  double velocity_rad_s(int joint) const { return velocity_[joint]; }
  const plant::JointPlant& plant(int joint) const { return joints_.plant(joint); }

 private:
  void Substep(double dt_s) noexcept;
  // Sets the chain to the joints' positions and velocities, and solves.
  void SolveChain() noexcept;
  void ReadSensors(provider::PlantSensors* sensors);

  RigidChain chain_;
  ActuatedJoints joints_;
  double substep_s_;
  provider::GearTruth truth_;
  JointVector position_, velocity_;  // in the order of the model
  // Work space of a step, in the order of the chain.
  JointVector chain_position_, chain_velocity_, acceleration_, torque_, added_, lower_, upper_,
      impulse_;
  JointMatrix inverse_, mixed_;
};

}  // namespace sinew::world
