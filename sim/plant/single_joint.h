// A joint whose link is wholly described by its model (inertia and gravity are terms): the shortest
// simulation there is, for experiments and for confirming a fitted model.
#pragma once

#include "sim/plant/joint_plant.h"

namespace sinew::plant {

class SingleJoint {
 public:
  // Throws std::invalid_argument as JointPlant; also when the model has no inertia at the output.
  SingleJoint(const actuator::JointModel& model, const JointPlantConfig& config);

  void Reset(double position_rad, double velocity_rad_s = 0.0);
  // One step; dt_s at most 1e-4 s where the joint has free play.
  void Step(double dt_s) noexcept;

  JointPlant& plant() { return plant_; }
  const JointPlant& plant() const { return plant_; }
  double position_rad() const { return position_rad_; }
  double velocity_rad_s() const { return velocity_rad_s_; }
  // Acceleration in the link's step that just ended.
  double acceleration_rad_s2() const { return acceleration_rad_s2_; }
  double inertia_kg_m2() const { return inertia_kg_m2_; }

 private:
  JointPlant plant_;
  double position_rad_ = 0.0, velocity_rad_s_ = 0.0, acceleration_rad_s2_ = 0.0;
  double inertia_kg_m2_ = 0.0;
};

}  // namespace sinew::plant
