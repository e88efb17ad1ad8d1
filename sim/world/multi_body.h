// A chain of bodies as Bullet's btMultiBody, set up so that its equations are the textbook ones
// (Featherstone: Rigid Body Dynamics Algorithms, ch. 7): link frames in the principal axes of the
// inertias with their origins at the centres of mass, no damping, the gyroscopic term, no limits of
// velocity or impulse. For fixed and floating bases. Thread: one. Allocates.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "components/bodies/links/bodies.h"

namespace sinew::world {

btVector3 ToBullet(const Eigen::Vector3d& v);
btTransform ToBullet(const Eigen::Isometry3d& frame);

// The principal frame of a body in its link's frame, and its principal moments, kg m^2.
struct Principal {
  btTransform frame = btTransform::getIdentity();
  btVector3 moments{0.0, 0.0, 0.0};
};

// com_m: in the link's frame. inertia_kg_m2: about the centre of mass, in the link's axes.
Principal PrincipalOf(const Eigen::Vector3d& com_m, const Eigen::Matrix3d& inertia_kg_m2);

struct MultiBody {
  std::unique_ptr<btMultiBody> body;
  Principal base;                   // identity for a fixed base
  std::vector<int> joint_bodies;    // body of each joint
  std::vector<btVector3> weight_N;  // per body, world axes
};

// Bodies and joints in the order of the chain. The inertia of the chain's base is read for a
// floating base only.
MultiBody MakeMultiBody(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2,
                        bool fixed_base);

}  // namespace sinew::world
