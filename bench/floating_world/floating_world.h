// A robot on a floating base over flat ground: chain, elastic joints, contacts and an IMU, stepped
// with joint torques.
//
// A step of length h, as World's: drift by h/2, kick, drift by h/2. The kick solves
// nu' = a(q, nu), q being the configuration half-way, by the explicit midpoint rule: forces and
// accelerations at nu, then at nu + h/2 a. Drift and kick are each exact or of second order, so
// smooth motion converges with h^2 (Strang splitting; Hairer, Lubich, Wanner: Geometric Numerical
// Integration (2006), II.5); a kick with a single evaluation would be of first order in Coriolis
// terms and damping. Contacts and springs are explicit: h must stay below 2 over the fastest rate,
// sqrt(k/m) of a spring and c/m of a damper (kFloatingSubstep_s has its figures).
//
// SI units; world axes, z up. Thread: one. Step allocates nothing and does not throw.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "sim/world/contact.h"
#include "sim/world/floating_chain.h"

namespace sinew::world {

// A point that may touch the ground: a force sensor of a foot, or a corner.
struct ContactPoint {
  std::string name;
  int body = kBaseBody;
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  // in the link's frame
};

// Spring and damper in a joint, such as the one between the segments of a foot:
// tau = -k (q - rest) - c q'.
struct ElasticJoint {
  int joint = 0;  // of the chain's joints
  double stiffness_Nm_rad = 0.0;
  double damping_Nm_s_rad = 0.0;
  double rest_rad = 0.0;
};

// Pushes that one step takes.
inline constexpr std::size_t kMostPushes = 8;

// With the default ground (k = 40 kN/m, a = 6.2 s/m, c_t = 140 N s/m) and four points under a foot
// of 0.2 kg the rates are sqrt(4 k / m) = 900 1/s for the springs, and at the static load 4 a N / m
// = 2500 1/s and 4 c_t / m = 2800 1/s for the dampers: h is 0.28 over the fastest, a seventh of the
// limit. Heavier loads raise the damping of the contact in proportion.
inline constexpr double kFloatingSubstep_s = 1e-4;

struct FloatingWorldConfig {
  arm::Chain chain;
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d(0.0, 0.0, -9.81);
  std::vector<ContactPoint> contacts;
  GroundConfig ground;
  std::vector<ElasticJoint> elastic_joints;
  Eigen::Isometry3d base_from_imu = Eigen::Isometry3d::Identity();  // in the base link (torso)
  double substep_s = kFloatingSubstep_s;
};

// In the IMU's axes. The specific force is acceleration less gravity: at rest it points up with
// 9.81 m/s^2.
struct ImuReading {
  Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_rad_s = Eigen::Vector3d::Zero();
};

enum class StepStatus {
  kOk,
  kBadInput,  // a torque or push was not finite or of no joint or body: it was taken as 0
  kDiverged,  // the state would not be finite: it stays that of before the step
};

class FloatingWorld {
 public:
  // Throws std::invalid_argument: what FloatingChain and GroundLaw refuse; a contact on a body or a
  // spring in a joint that is not there; a value that is not finite; a substep not above 0.
  explicit FloatingWorld(const FloatingWorldConfig& config);

  const FloatingChain& chain() const { return chain_; }
  const GroundLaw& ground() const { return ground_; }
  double substep_s() const { return substep_s_; }

  // Sets the state; the points have touched nothing yet and the forces are 0. Throws
  // std::invalid_argument: sizes that are not the chain's, or values that are not finite.
  void Reset(const FloatingState& state);

  // One substep with these torques (one a joint, Nm or N), held over it, and pushes from outside,
  // which follow their points. At most kMostPushes; further ones are bad input.
  StepStatus Step(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm,
                  std::span<const LinkForce> pushes = {}) noexcept;

  const FloatingState& state() const { return state_; }
  // Of the last step, in the order of the configuration: what the force sensors measure.
  std::span<const ContactForce> contact_forces() const { return contact_forces_; }
  // The mean specific force of the last step (0 after Reset) and the angular velocity at its end.
  const ImuReading& imu() const { return imu_; }

 private:
  // nu' at the configuration half-way with these velocities.
  void Accelerate(std::size_t push_count) noexcept;
  // Copies what is finite and belongs to a joint or body; false when something was left out.
  bool TakeInput(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm,
                 std::span<const LinkForce> pushes, std::size_t* push_count) noexcept;
  // orientation, angular_velocity (world axes): half-way, where acceleration_ holds.
  void ReadImu(const Eigen::Quaterniond& orientation,
               const Eigen::Vector3d& angular_velocity) noexcept;

  FloatingChain chain_;
  GroundLaw ground_;
  std::vector<ContactPoint> contacts_;
  std::vector<ElasticJoint> elastic_joints_;
  Eigen::Isometry3d base_from_imu_;
  double substep_s_;

  FloatingState state_, middle_;
  std::vector<ContactMemory> memory_, next_memory_;
  std::vector<ContactForce> contact_forces_, next_forces_;
  std::vector<LinkForce> forces_;  // of the contacts, then pushes
  Eigen::VectorXd input_Nm_, torque_Nm_, acceleration_;
  ImuReading imu_;
};

}  // namespace sinew::world
