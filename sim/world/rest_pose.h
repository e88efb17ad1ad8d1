// The pose in which a robot on a floating base is at rest on its contacts, its driven joints held
// where they are: what contacts and springs push is what the weight needs.
//
// Unknown x: the base's turn about the two horizontal axes, its height, the passive joints. With
// the contacts' normal forces k d (contact.h at rest, d the depth), gravity g at the bodies'
// centres of mass and the passive joints' springs, their generalised forces vanish:
//
//     r(x) = sum_contacts J' k d e_z + sum_bodies m J' g - K q = 0
//
// by Newton's method, dr/dx by central differences. -dr/dx must be positive definite, or the pose
// is no minimum of the energy and the robot would not stay in it. Heading and place stay.
//
// SI units; world axes, z up. Pure; allocates; any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "sim/world/floating_chain.h"

namespace sinew::world {

struct RestContact {
  int body = kBaseBody;
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // in the body's frame
};

struct RestSpring {
  int joint = 0;  // of the chain
  double stiffness_Nm_rad = 0.0;
};

struct RestGround {
  double height_m = 0.0;
  double stiffness_N_m = 0.0;  // of a contact
};

// bodies: what `chain` was made of. start: upright, with contacts that carry the weight; its joints
// that are no springs stay. The chain is left in the pose. Throws std::invalid_argument when no
// such pose is found: the robot would fall over, or its contacts do not carry it.
FloatingState RestPose(const arm::Chain& bodies, const std::vector<RestContact>& contacts,
                       const std::vector<RestSpring>& springs, const RestGround& ground,
                       const FloatingState& start, FloatingChain& chain);

}  // namespace sinew::world
