// A chain as a skeleton of DART (Lee et al.: DART: Dynamic Animation and Robotics Toolkit, Journal
// of Open Source Software 3 (2018) 500), built from arm::Chain without any loader: the reference of
// the floating chain's tests and measurements. Allocates.
#pragma once

#include <Eigen/Geometry>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <span>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "sim/world/floating_chain.h"

namespace sinew::world {

class DartChain {
 public:
  DartChain(const arm::Chain& chain, bool fixed_base,
            const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -9.81))
      : skeleton_(dart::dynamics::Skeleton::create(chain.name)), fixed_base_(fixed_base) {
    using namespace dart::dynamics;
    skeleton_->setGravity(gravity_m_s2);
    BodyNode* base = fixed_base ? Add<WeldJoint>(nullptr, "base", "root", Eigen::Vector3d::Zero())
                                : Add<FreeJoint>(nullptr, "base", "root", Eigen::Vector3d::Zero());
    if (!fixed_base) {
      base->setInertia({chain.base.mass_kg, chain.base.com_m, chain.base.inertia_kg_m2});
    }
    nodes_.push_back(base);
    for (const arm::Body& body : chain.bodies) {
      BodyNode* parent = nodes_[static_cast<std::size_t>(body.parent + 1)];
      BodyNode* node = nullptr;
      if (!body.moves) {
        node = Add<WeldJoint>(parent, body.link_name, body.joint_name, Eigen::Vector3d::Zero());
      } else if (body.prismatic) {
        node = Add<PrismaticJoint>(parent, body.link_name, body.joint_name, body.axis);
      } else {
        node = Add<RevoluteJoint>(parent, body.link_name, body.joint_name, body.axis);
      }
      node->getParentJoint()->setTransformFromParentBodyNode(body.parent_from_joint);
      node->setInertia({body.mass_kg, body.com_m, body.inertia_kg_m2});
      nodes_.push_back(node);
      if (body.moves) joints_.push_back(node->getParentJoint());
    }
  }

  // The state's base is read for a floating base only.
  void SetState(const FloatingState& state) {
    if (!fixed_base_) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.linear() = state.orientation.toRotationMatrix();
      pose.translation() = state.position_m;
      auto* free = static_cast<dart::dynamics::FreeJoint*>(skeleton_->getRootJoint());
      free->setTransform(pose);
      // Base axes: [w; v].
      Eigen::Vector6d twist;
      twist.head<3>() = pose.linear().transpose() * state.velocity.head<3>();
      twist.tail<3>() = pose.linear().transpose() * state.velocity.segment<3>(3);
      free->setRelativeSpatialVelocity(twist);
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      joints_[j]->setPosition(0, state.joint_position_rad[at]);
      joints_[j]->setVelocity(0, state.velocity[kBaseFreedom + at]);
    }
  }

  // nu' as FloatingChain defines it; a fixed base has zeros there.
  void Solve(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm, std::span<const LinkForce> forces,
             Eigen::Ref<Eigen::VectorXd> acceleration) {
    skeleton_->clearExternalForces();
    for (const LinkForce& at : forces) {
      nodes_[static_cast<std::size_t>(at.body + 1)]->addExtForce(at.force_N, at.point_m, false,
                                                                 true);
    }
    nodes_.front()->addExtTorque(moment_Nm_, false);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      joints_[j]->setForce(0, torque_Nm[static_cast<Eigen::Index>(j)]);
    }
    skeleton_->computeForwardDynamics();
    acceleration.head<3>() = nodes_.front()->getAngularAcceleration();
    acceleration.segment<3>(3) = nodes_.front()->getLinearAcceleration();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      acceleration[kBaseFreedom + static_cast<Eigen::Index>(j)] = joints_[j]->getAcceleration(0);
    }
  }

  // H nu' + h, as FloatingChain defines nu', in the state that was set: DART's own inverse
  // dynamics. Floating base only.
  void Force(const Eigen::Ref<const Eigen::VectorXd>& acceleration,
             Eigen::Ref<Eigen::VectorXd> force) {
    skeleton_->clearExternalForces();
    auto* free = static_cast<dart::dynamics::FreeJoint*>(skeleton_->getRootJoint());
    const Eigen::Matrix3d rotation = free->getChildBodyNode()->getWorldTransform().linear();
    // Base axes: the derivative of [w; v].
    const Eigen::Vector6d twist = free->getRelativeSpatialVelocity();
    Eigen::Vector6d change;
    change.head<3>() = rotation.transpose() * acceleration.head<3>();
    change.tail<3>() =
        rotation.transpose() * acceleration.segment<3>(3) - twist.head<3>().cross(twist.tail<3>());
    free->setRelativeSpatialAcceleration(change);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      joints_[j]->setAcceleration(0, acceleration[kBaseFreedom + static_cast<Eigen::Index>(j)]);
    }
    skeleton_->computeInverseDynamics();
    const Eigen::Vector6d on_base = nodes_.front()->getBodyForce();
    force.head<3>() = rotation * on_base.head<3>();
    force.segment<3>(3) = rotation * on_base.tail<3>();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      force[kBaseFreedom + static_cast<Eigen::Index>(j)] = joints_[j]->getForce(0);
    }
  }

  // H^-1 in FloatingChain's coordinates, or of the joints alone with a fixed base: accelerations of
  // unit forces at rest without gravity. getInvMassMatrix of DART 6.12 differs from these by half
  // of their size on the random trees, not on the bipeds. Leaves the velocities at 0.
  Eigen::MatrixXd Responses() {
    const Eigen::Vector3d gravity = skeleton_->getGravity();
    skeleton_->setGravity(Eigen::Vector3d::Zero());
    // Not getVelocities(): a vector that DART allocates must not be freed here, where under the
    // address sanitizer Eigen allocates in another way.
    skeleton_->setVelocities(
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(skeleton_->getNumDofs())));
    const auto joints = static_cast<Eigen::Index>(joints_.size());
    const Eigen::Index all = kBaseFreedom + joints;
    Eigen::MatrixXd inverse(all, all);
    Eigen::VectorXd column(all);
    for (Eigen::Index k = 0; k < all; ++k) {
      const bool joint = k >= kBaseFreedom;
      LinkForce force;
      if (k >= 3 && !joint) force.force_N = Eigen::Vector3d::Unit(k - 3);
      moment_Nm_.setZero();
      if (k < 3) moment_Nm_[k] = 1.0;
      Eigen::VectorXd torque = Eigen::VectorXd::Zero(joints);
      if (joint) torque[k - kBaseFreedom] = 1.0;
      Solve(torque, {&force, 1}, column);
      inverse.col(k) = column;
    }
    moment_Nm_.setZero();
    skeleton_->setGravity(gravity);
    return fixed_base_ ? inverse.bottomRightCorner(joints, joints).eval() : inverse;
  }

  const dart::dynamics::SkeletonPtr& skeleton() const { return skeleton_; }

 private:
  // axis: of a joint that has one.
  template <typename Joint>
  dart::dynamics::BodyNode* Add(dart::dynamics::BodyNode* parent, const std::string& link_name,
                                const std::string& joint_name, const Eigen::Vector3d& axis) {
    typename Joint::Properties joint;
    joint.mName = joint_name;
    if constexpr (requires { joint.mAxis; }) joint.mAxis = axis;
    const dart::dynamics::BodyNode::AspectProperties node(link_name);
    return skeleton_->createJointAndBodyNodePair<Joint>(parent, joint, node).second;
  }

  dart::dynamics::SkeletonPtr skeleton_;
  bool fixed_base_;
  Eigen::Vector3d moment_Nm_ = Eigen::Vector3d::Zero();  // on the base, world axes
  std::vector<dart::dynamics::BodyNode*> nodes_;
  std::vector<dart::dynamics::Joint*> joints_;
};

}  // namespace sinew::world
