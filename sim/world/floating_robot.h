// The simulated robot on a floating base as a state provider's plant: a chain in Bullet with
// actuated (actuated_joints.h) and passive joints, contacts with flat ground, force sensors and an
// IMU.
//
// Links on fixed joints are merged into those that carry them (arm::MergeFixedLinks); their names
// stay frames for contacts, IMU, payload and push.
//
// A cycle is cut into equal steps of at most substep_s. A step of length h is drift by h/2, kick,
// drift by h/2, as World's and FloatingWorld's. The kick, at the configuration half-way:
//
//     M (nu' - nu) = h H a + S p,   M = H + R + h/2 C,   -h F <= p <= h F
//
// H a: all forces on the chain without the rotors, at nu for what drives and damps, at nu + h/2 of
// the last step's acceleration for the Coriolis terms. So one solution of the chain's equations
// makes smooth motion converge with h^2. R: inertia that the plants add, on the driven joints. C:
// damping of contacts and passive joints, -dF/dnu; with it in M the kick is the linearly implicit
// midpoint rule (a Rosenbrock method of order 2; Hairer, Wanner: Solving Ordinary Differential
// Equations II (1996), IV.7), stable whatever the damping is. p: impulses of the joints (S selects
// them), with the bounds of friction F and the URDF's hard stops, by plant::ApplyImpulsesFrom with
// the joints' block of M^-1. Springs are explicit: h must stay below 2 over the fastest sqrt(k/m)
// (kRobotSubstep_s has its figures).
//
// What a force sensor feels is the mean of the last step, the one that the kick used. Readings of
// force sensors and IMU have the errors of sensor_errors.h; the IMU's orientation and the truth
// have none.
//
// SI units; world axes, z up, ground as GroundConfig. Joints: a linear one reads m for rad and N
// for Nm. Thread: one. Two robots of one configuration give bit-identical results.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "components/bodies/links/fixed_links.h"
#include "components/model/actuator/model.h"
#include "components/robot/provider/simulated_plant.h"
#include "sim/world/actuated_joints.h"
#include "sim/world/contact.h"
#include "sim/world/floating_chain.h"
#include "sim/world/sensor_errors.h"
#include "sim/world/tree_factor.h"

namespace sinew::world {

// A point that may touch the ground: where a link of the URDF is, or a point in its frame.
struct ContactFrame {
  std::string link;
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
};

// With the default ground (k = 40 kN/m) the fastest spring is a toe of 0.1 kg on two points,
// sqrt(2 k / m) = 900 1/s: h = 0.22 of it, a ninth of the limit. Joints with free play: at most
// 1e-4 s, as in World.
inline constexpr double kRobotSubstep_s = 2.5e-4;

// The pose of the base and of the passive joints at the start.
enum class StartPose {
  kUpright,  // passive joints at 0: those with load on them give way, and the robot rocks on them
  kAtRest,   // as rest_pose.h finds it
};

// White noise of the sensors, standard deviations of every reading; 0: none. It is in what is
// read: the drives' own loops close on the truth. A force sensor has it where nothing touches, too,
// and may read below 0. The first reading after Reset starts the sequence of the seed.
struct SensorNoise {
  std::uint64_t seed = 1;
  double motor_current_A = 0.0;
  double foot_force_N = 0.0;
  double orientation_rad = 0.0;         // a turn about each axis of the IMU
  double angular_velocity_rad_s = 0.0;  // per axis
  double acceleration_m_s2 = 0.0;       // per axis
  bool any() const {
    return motor_current_A > 0.0 || foot_force_N > 0.0 || orientation_rad > 0.0 ||
           angular_velocity_rad_s > 0.0 || acceleration_m_s2 > 0.0;
  }
};

struct FloatingRobotConfig {
  arm::Chain chain;                      // as read from the URDF
  actuator::RobotModel model;            // a joint for every moving joint that is not passive
  std::vector<WorldJointConfig> joints;  // as model.joints; empty: defaults
  // The first eight are the force sensors in the order of provider::BodySensors::foot_force_N;
  // further ones carry as well, without a sensor.
  std::vector<ContactFrame> contacts;
  GroundConfig ground;
  std::string imu_link;  // fixed to the base; its axes are the IMU's; empty: no IMU
  // Height of the base link's origin at the start, upright over x = y = 0. Left out: such that the
  // contacts carry the weight at rest, joints at their start.
  std::optional<double> base_height_m;
  double substep_s = kRobotSubstep_s;
  StartPose start = StartPose::kUpright;
  ImuErrors imu_errors;
  SensorErrors foot_errors;  // N
  std::uint64_t seed = 1;    // of the sensors' errors
  SensorNoise noise = {};
};

class FloatingRobot final : public provider::SimulatedPlant {
 public:
  // Throws std::invalid_argument naming joint or link: what ActuatedJoints, FloatingChain and
  // GroundLaw refuse; a model with inertia or gravity of its link, or a declared payload (both are
  // the URDF's); a link that is not there; an IMU on a moving link; no contact to stand on and no
  // height; a start at rest with a height, or where there is no rest; values that are not finite;
  // what SensorRow refuses.
  explicit FloatingRobot(const FloatingRobotConfig& config);

  int joint_count() const override { return joints_.count(); }
  bool prismatic(int joint) const override { return joints_.prismatic(joint); }
  std::string joint_name(int joint) const override { return joints_.name(joint); }
  std::uint32_t measured_flags() const override { return joints_.measured_flags(); }
  // Forces of the feet are those of the start; the IMU reads what it does at rest. The sensors'
  // errors begin anew with the seed.
  void Reset(provider::PlantSensors* sensors) override;
  // Both: values that are not finite as in ActuatedJoints. Hand forces act through the model's
  // link length, in the joint alone; a payload on the body is DisturbBody's.
  void Disturb(const provider::Disturbance& disturbance) override { joints_.Disturb(disturbance); }
  void ImposePressure(const provider::ImposedPressure& pressure) override {
    joints_.ImposePressure(pressure);
  }
  const provider::GearTruth& gear_truth() const override { return gear_truth_; }
  // A payload is a point mass that the link carries from now on. Payload or push with a value that
  // is not finite, and payloads below 0, are none. A lost drive has no torque, whatever it is
  // commanded; its rotor and friction stay. Lost friction outside 0 to 1 is none. Allocates when
  // the payload changes: the chain is built again.
  void DisturbBody(const provider::BodyDisturbance& disturbance) override;
  bool HasDrive(const std::string& joint) const override { return joints_.Find(joint) >= 0; }
  const provider::BodyTruth* body_truth() const override { return &body_truth_; }
  const provider::BodySensors* body_sensors() const override { return &body_sensors_; }
  // Allocates nothing. A state that would not be finite is not taken: the plant reports a fault and
  // stands still until Reset.
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;

  // Truth, for tests and experiments. Joints of chain and state: the moving ones of the URDF. The
  // chain is in the state of the last kick, half a step before state().
  const FloatingChain& chain() const { return chain_; }
  const FloatingState& state() const { return state_; }
  const arm::MergedChain& links() const { return merged_; }
  const plant::JointPlant& plant(int joint) const { return joints_.plant(joint); }
  // On the robot, world axes, in the order of the configuration.
  const std::vector<ContactForce>& contact_forces() const { return contact_forces_; }

 private:
  struct Contact {
    int body = kBaseBody;
    Eigen::Vector3d point_m;
    ContactMemory memory;
    Eigen::Matrix3Xd jacobian;
  };
  struct PassiveJoint {
    int joint = 0;  // of the chain
    arm::Passive law;
    double lower = 0.0, upper = 0.0;
  };
  struct Payload {
    int body = kBaseBody;
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
    double mass_kg = 0.0;
    bool operator==(const Payload&) const = default;
  };

  const arm::LinkFrame& Link(const std::string& name, const std::string& what) const;
  double StartHeight(const FloatingState& upright, std::optional<double> asked_m);
  FloatingState AtRest(const FloatingState& upright);
  void SetPayload(const Payload& payload);
  bool Substep(double dt_s) noexcept;  // false: the state would not be finite and stays
  // Forces of the contacts at nu, and what they add to M.
  void TouchGround(double dt_s) noexcept;
  // Torques, added inertia and bounds of all joints.
  void LoadJoints(double dt_s) noexcept;
  // From the accelerations of the chain alone to nu'; false: M is not positive definite.
  bool Kick(double dt_s) noexcept;
  void ReadContacts() noexcept;
  void ReadImu() noexcept;
  void FollowSensors(double dt_s) noexcept;  // as they feel the end of a step
  Eigen::Vector3d AngularVelocityOfImu() const noexcept;
  void GatherFeet() noexcept;
  void ReadSensors(provider::PlantSensors* sensors);
  void ReadOrientation() noexcept;
  void AddNoise(provider::PlantSensors* sensors) noexcept;

  arm::MergedChain merged_;
  FloatingChain chain_;
  ActuatedJoints joints_;
  GroundConfig ground_config_;
  GroundLaw ground_;
  double substep_s_;
  std::vector<Contact> contacts_;
  std::vector<PassiveJoint> passive_;
  std::optional<Eigen::Isometry3d> base_from_imu_;
  FloatingState start_, state_;
  Payload payload_;
  bool diverged_ = false;
  SensorNoise noise_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;

  // Work space of a step. Vectors of joints: in the order of the chain.
  FloatingState before_;
  Eigen::VectorXd ahead_;         // nu for the Coriolis terms
  Eigen::VectorXd acceleration_;  // of the last step, nu' - nu over its length
  Eigen::VectorXd chain_acceleration_, change_;
  Eigen::VectorXd torque_, added_, lower_, upper_, joint_velocity_;
  Eigen::VectorXd impulse_;  // of the last step: where the next one's search begins
  Eigen::MatrixXd inertia_, joint_inverse_;
  TreeFactor factor_;
  std::vector<LinkForce> forces_;      // of the contacts, then the push
  std::vector<PointInertia> damping_;  // h/2 C of the contacts
  std::vector<ContactForce> contact_forces_;
  Eigen::Vector3d specific_force_m_s2_ = Eigen::Vector3d::Zero();
  std::array<double, 8> foot_force_N_{};  // without errors
  SensorRow force_axes_, rate_axes_, feet_;

  provider::GearTruth gear_truth_;
  provider::BodySensors body_sensors_;
  provider::BodyTruth body_truth_;
};

}  // namespace sinew::world
