// robots/biped as a chain, and motions of its joints.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/bodies/leg/geometry.h"
#include "components/bodies/leg/squat.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/bodies/stance/double_support.h"

namespace sinew::stance {

inline arm::Chain ReadNuBiped() {
  std::ifstream stream(SINEW_SOURCE_DIR "/robots/biped/biped.urdf");
  std::ostringstream text;
  text << stream.rdbuf();
  return arm::ParseUrdf(text.str(), "biped.urdf");
}

// The same robot with the pelvis's mass in the base link, which FloatingChain needs.
inline arm::Chain WithMassInBase(arm::Chain chain) {
  for (arm::Body& body : chain.bodies) {
    if (body.link_name != "pelvis") continue;
    chain.base.mass_kg = body.mass_kg;
    chain.base.com_m = body.parent_from_joint * body.com_m;
    chain.base.inertia_kg_m2 = body.inertia_kg_m2;  // its frame is parallel to the base's
    body.mass_kg = 0.0;
    body.inertia_kg_m2.setZero();
  }
  return chain;
}

struct JointsMotion {
  Eigen::VectorXd q, v, a;
};

inline Eigen::Index JointIndex(const arm::FloatingDynamics& dynamics, const std::string& name) {
  const std::vector<std::string>& names = dynamics.joint_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument("no joint " + name);
  return found - names.begin();
}

// Both legs squat: hip centres at this height above the ankle pitch axes. Throws
// std::bad_optional_access where the leg does not reach.
inline JointsMotion Squat(const arm::FloatingDynamics& dynamics, const leg::LegGeometry& geometry,
                          const leg::HipHeight& hip) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dynamics.joints());
  JointsMotion out{zero, zero, zero};
  const leg::SquatMotion squat = leg::SquatAt(geometry, 0.0, hip).value();
  for (const std::string side : {"left_", "right_"}) {
    const auto set = [&](const char* joint, const leg::JointMotion& motion) {
      const Eigen::Index j = JointIndex(dynamics, side + joint);
      out.q[j] = motion.position_rad;
      out.v[j] = motion.velocity_rad_s;
      out.a[j] = motion.acceleration_rad_s2;
    };
    set("hip_pitch", squat.hip_pitch);
    set("knee", squat.knee);
    set("ankle_pitch", squat.ankle_pitch);
  }
  return out;
}

}  // namespace sinew::stance
