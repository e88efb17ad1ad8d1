// A model file's content for robots/biped: rotor and friction of every driven joint.
#pragma once

#include "components/bodies/links/bodies.h"
#include "components/model/actuator/model.h"
#include "tests/components/robot/control/terms.h"

namespace sinew::stance {

inline constexpr double kRotor_kg_m2 = 0.05, kViscous_Nm_s_rad = 0.4, kCoulomb_Nm = 0.8;

inline actuator::RobotModel BipedModel(const arm::Chain& chain) {
  actuator::RobotModel robot;
  robot.name = "biped";
  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsDriven(body)) continue;
    actuator::JointModel joint;
    joint.name = body.joint_name;
    joint.constants = {.gear_ratio = 80.0, .torque_constant_Nm_A = 0.0159};
    control::AddTerm(&joint, "drive_current", {0.75});
    control::AddTerm(&joint, "rotor_inertia", {kRotor_kg_m2});
    control::AddTerm(&joint, "viscous", {kViscous_Nm_s_rad});
    control::AddTerm(&joint, "coulomb", {kCoulomb_Nm});
    robot.joints.push_back(joint);
  }
  return robot;
}

}  // namespace sinew::stance
