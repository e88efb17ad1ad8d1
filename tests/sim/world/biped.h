// The foreign bipeds of ../shared/data/biped_12dof_urdf, with contact points at the corners of
// their feet, standing.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "bench/floating_world/floating_world.h"
#include "components/bodies/links/bodies.h"
#include "components/bodies/links/file/urdf_file.h"

namespace sinew::world {

inline std::string BipedPath(const std::string& file) {
  return std::string(SINEW_SHARED_DIR) + "/data/biped_12dof_urdf/" + file;
}

inline arm::Chain ReadBiped(const std::string& file) {
  std::ifstream stream(BipedPath(file));
  std::ostringstream text;
  text << stream.rdbuf();
  return arm::ParseUrdf(text.str(), file);
}

inline const std::string kBerkeleyBiped = "berkeley_humanoid_lite_biped.urdf";

struct StandingBiped {
  FloatingWorldConfig config;
  FloatingState state;  // knees bent a little, soles level at height 0
  Eigen::VectorXd posture_rad;
  int driven_joints = 0;  // the first ones; toes are passive
};

// The Berkeley Humanoid Lite on the corners of its feet: the box of the URDF, 0.072 x 0.22 x 0.04 m
// at (0, 0.03, 0.006), turned by 90 degrees about x, so that the sole is at y = 0.05 of the link.
// Without toes its four lower corners touch. With toes the front third of each foot is a segment of
// its own behind an elastic hinge; two points under each segment touch.
inline StandingBiped MakeStandingBiped(bool toes = false) {
  constexpr double kSole_m = 0.05, kHinge_m = 0.04, kBack_m = -0.104, kFront_m = 0.116;
  constexpr double kHingeForward_m = 0.05;
  StandingBiped out;
  arm::Chain& chain = out.config.chain;
  chain = ReadBiped(kBerkeleyBiped);
  const int bodies = static_cast<int>(chain.bodies.size());
  for (const arm::Body& body : chain.bodies) out.driven_joints += body.moves ? 1 : 0;
  for (int body = 0; body < bodies; ++body) {
    const std::string name = chain.bodies[static_cast<std::size_t>(body)].link_name;
    if (name != "leg_left_ankle_roll" && name != "leg_right_ankle_roll") continue;
    int front = body;
    Eigen::Vector3d hinge = Eigen::Vector3d::Zero();
    if (toes) {
      hinge = {0.0, kHinge_m, kHingeForward_m};
      arm::Body toe;
      toe.link_name = toe.joint_name = name + "_toe";
      toe.parent = body;
      toe.moves = true;
      toe.parent_from_joint.translate(hinge);
      toe.axis = Eigen::Vector3d::UnitX();
      // A plate of 0.072 x 0.01 x 0.066 m.
      toe.mass_kg = 0.06;
      toe.com_m = {0.0, 0.005, 0.033};
      toe.inertia_kg_m2 = Eigen::Vector3d(2.2e-5, 4.8e-5, 2.6e-5).asDiagonal();
      front = static_cast<int>(chain.bodies.size());
      const int joint = out.driven_joints + static_cast<int>(out.config.elastic_joints.size());
      chain.bodies.push_back(toe);
      out.config.elastic_joints.push_back(
          {.joint = joint, .stiffness_Nm_rad = 100.0, .damping_Nm_s_rad = 0.5});
    }
    for (const double x : {-0.036, 0.036}) {
      out.config.contacts.push_back({name, body, {x, kSole_m, kBack_m}});
      const Eigen::Vector3d corner(x, kSole_m, kFront_m);
      out.config.contacts.push_back({name, front, corner - hinge});
    }
  }
  FloatingChain at_posture(chain);
  out.posture_rad = Eigen::VectorXd::Zero(at_posture.joint_count());
  for (int joint = 0; joint < at_posture.joint_count(); ++joint) {
    const auto body =
        static_cast<std::size_t>(at_posture.joint_bodies()[static_cast<std::size_t>(joint)]);
    const std::string& name = chain.bodies[body].joint_name;
    const auto has = [&name](const char* part) { return name.find(part) != std::string::npos; };
    // Bent by 0.4 rad in the knee; hip and ankle keep the trunk upright and the soles level.
    if (has("hip_pitch") || has("ankle_pitch")) out.posture_rad[joint] = -0.2;
    if (has("knee_pitch")) out.posture_rad[joint] = 0.4;
  }
  out.state = at_posture.Rest();
  out.state.joint_position_rad = out.posture_rad;
  at_posture.SetState(out.state);
  double lowest = 1.0;
  for (const ContactPoint& contact : out.config.contacts) {
    lowest = std::min(lowest, at_posture.Point(contact.body, contact.point_m).position_m.z());
  }
  out.state.position_m.z() = -lowest;
  const auto points = static_cast<double>(out.config.contacts.size());
  out.config.ground.static_load_N = at_posture.mass_kg() * 9.81 / points;
  return out;
}

// PD torque that holds the posture: stiff springs, each damped about half of critically with the
// inertia of the body above the ankles, 0.1 kg m^2 and more.
inline void HoldPosture(const StandingBiped& biped, const FloatingState& state,
                        Eigen::VectorXd* torque_Nm) {
  constexpr double kStiffness_Nm_rad = 300.0, kDamping_Nm_s_rad = 6.0;
  const Eigen::Index joints = biped.posture_rad.size();
  *torque_Nm = kStiffness_Nm_rad * (biped.posture_rad - state.joint_position_rad) -
               kDamping_Nm_s_rad * state.velocity.tail(joints);
  torque_Nm->tail(joints - biped.driven_joints).setZero();
}

}  // namespace sinew::world
