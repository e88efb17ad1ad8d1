// A chain of bodies as Bullet's btMultiBody, set up so that its equations are the textbook ones
// (Featherstone: Rigid Body Dynamics Algorithms, ch. 7): link frames in the principal axes of the
// inertias with their origins at the centres of mass, no damping, the gyroscopic term, no limits of
// velocity or impulse. For fixed and floating bases.
//
// A joint that mimics another is coupled to it: C a = 0, a the accelerations of all moving bodies
// as Bullet has them, with a row of C for each such joint: 1 there, -multiplier at the joint that
// it follows. Its torque l makes of the accelerations a0 without it
//
//     a = a0 + A C' l,   l = -(C A C')^-1 C a0,   A = H^-1
//
// (Featherstone, 8.2). Positions and velocities are set from those of the free joints, so the ratio
// is exact. Thread: one. Allocates but for Respond, and for Accelerate after the first.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <Eigen/Cholesky>
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
  Principal base;                            // identity for a fixed base
  std::vector<int> joint_bodies;             // body of each free joint
  std::vector<btVector3> weight_N;           // per body, world axes
  std::vector<arm::Coordinate> coordinates;  // per body
  Eigen::VectorXd force, response;           // of the base 6, then of each moving body

  // One entry for each free joint.
  void SetPositions(const Eigen::Ref<const Eigen::VectorXd>& position) noexcept;
  void SetVelocities(const Eigen::Ref<const Eigen::VectorXd>& velocity) noexcept;
  // Accelerations by the forces that were added to the body, into `response`.
  void Accelerate() noexcept;
  // Accelerations by `force` alone, into `response`, in the state of the last Accelerate.
  void Respond() noexcept;
  // Entry of `force` and `response` of a free joint; of a body.
  int Entry(std::size_t joint) const { return EntryOf(joint_bodies[joint]); }
  int EntryOf(int index) const { return 6 + body->getLink(index).m_dofOffset; }

  void Couple() noexcept;  // adds what the couplings make of `response`

  Eigen::MatrixXd C, a_ct, c_a_ct;
  Eigen::VectorXd coupling;  // C a0, then -l
  Eigen::LLT<Eigen::MatrixXd> factor;
  btAlignedObjectArray<btScalar> scratch_r;
  btAlignedObjectArray<btVector3> scratch_v;
  btAlignedObjectArray<btMatrix3x3> scratch_m;
};

// Bodies and joints in the order of the chain. The inertia of the chain's base is read for a
// floating base only.
MultiBody MakeMultiBody(const arm::Chain& chain, const Eigen::Vector3d& gravity_m_s2,
                        bool fixed_base);

}  // namespace sinew::world
