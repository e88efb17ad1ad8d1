#include "sim/plant/single_joint.h"

#include "sim/plant/friction.h"

namespace sinew::plant {

SingleJoint::SingleJoint(const actuator::JointModel& model, const JointPlantConfig& config)
    : plant_(model, config) {
  Reset(0.0);
}

void SingleJoint::Reset(double position_rad, double velocity_rad_s) {
  plant_.Reset(position_rad, 0.0);
  position_rad_ = position_rad;
  velocity_rad_s_ = velocity_rad_s;
  acceleration_rad_s2_ = 0.0;
}

void SingleJoint::Step(double dt_s) noexcept {
  const double before = velocity_rad_s_;
  position_rad_ += 0.5 * dt_s * velocity_rad_s_;
  const LinkLoad load = plant_.Begin(position_rad_, velocity_rad_s_, dt_s);
  inertia_kg_m2_ = load.added_inertia_kg_m2;
  const double inverse = 1.0 / inertia_kg_m2_;
  velocity_rad_s_ += dt_s * inverse * load.torque_Nm;
  const double bound = dt_s * load.friction_Nm, lower = -bound;
  double impulse = 0.0;
  ApplyImpulses({&inverse, 1}, {&lower, 1}, {&bound, 1}, {&impulse, 1}, {&velocity_rad_s_, 1});
  position_rad_ += 0.5 * dt_s * velocity_rad_s_;
  acceleration_rad_s2_ = (velocity_rad_s_ - before) / dt_s;
  plant_.End(position_rad_, velocity_rad_s_, dt_s);
}

}  // namespace sinew::plant
