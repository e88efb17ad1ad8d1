// The fall of a robot on two legs as a fault of its state provider: the detector of
// components/robot/fall with what a provider's cycle knows.
//
// Measured. Feet and IMU are the plant's (BodySensors, order and signs as in idl/sensors.idl). With
// q the joint positions of the leg that carries more, R and p its sole in the base by
// leg::Forward(q), and R_IB the base's axes in the IMU's frame, the detector's vector from the sole
// to the base is
//
//     foot_to_base = -R_IB p(q)
//
// Asked. The detector compares the base's height with the one it should have at this moment. That
// follows from the position that each joint of the same leg is asked to be at, q_r, with the sole
// flat on the ground:
//
//     reference height = -e_z . R(q_r)' p(q_r)
//
// so that a squat moves both, and a base that does not follow is a fall. q_r is what the plant is
// asked by the guard: of a command that passes the position of joint_command, whatever its mode
// (idl/joint.idl: where the joint should be), of a hold the held one. A joint that idles or that
// the provider damps is asked nothing new; before its first command it is asked to stay where it
// was when the robot was armed. Not the topic reference: control follows it late, blended or not at
// all (its own fault, a standby, an order to hold), and in lockstep joint_command is here in the
// tick that it answers, without one more topic to wait for. A controller that asks for a pose in
// which the robot falls over is found by tilt and free fall. While the robot may not move nobody
// asks for a height: the reference is the measured one, and tilt, free fall and lost sensors are
// left.
//
// What is too late or lost among the commands is CommandGuard's to assess; the reference stays.
//
// A robot that may move while the detector has not started for longer than start_within_s counts as
// fallen: it would go on unwatched. What was found stays until Reset. Times are ticks of the
// provider, one period apart.
//
// SI units. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "components/base/types/joints.h"
#include "components/base/types/robot_state.h"
#include "components/bodies/leg/kinematics.h"
#include "components/robot/fall/fall_detector.h"
#include "components/robot/provider/plant.h"

namespace sinew::provider {

struct GuardedLeg {
  leg::LegGeometry geometry;
  std::array<int, leg::kLegJoints>
      joint{};  // index among the plant's joints, order of leg::LegJoint
};

struct FallGuardConfig {
  fall::FallConfig detector;
  GuardedLeg right, left;
  Eigen::Matrix3d imu_from_base = Eigen::Matrix3d::Identity();  // R_IB; base: the legs' pelvis
  int joint_count = 0;                                          // of the robot
  double start_within_s = 10.0;
};

class FallGuard {
 public:
  // Throws std::invalid_argument: a joint that the robot does not have, a matrix that is no
  // rotation (to 1e-6), a time that is not positive; what fall::FallDetector refuses.
  FallGuard(const FallGuardConfig& config, double period_s);

  // After each step of the plant. asked: the command of that step, where it is a controller's or a
  // hold; null where the joints idle or are damped. True: a fall was found, once.
  bool Step(std::uint64_t tick, const PlantSensors& sensors, const BodySensors& body,
            types::RobotState state, const PlantCommand* asked) noexcept;
  // The operator's reset: the detector starts anew.
  void Reset() noexcept;

  bool upright() const noexcept { return !fallen_ && output_.state == fall::FallState::kUpright; }
  bool fallen() const noexcept { return fallen_; }
  // Output of the last step.
  const fall::FallOutput& output() const noexcept { return output_; }
  double reference_height_m() const noexcept { return reference_height_m_; }
  // The finding, with criterion and figures: "fall: tilt 24.1 deg, limit 22.7 deg". Empty: nothing.
  std::string_view message() const noexcept { return {message_.data(), message_size_}; }
  // Why the robot may not be armed; empty: it may. Allocates.
  std::string ArmRefusal() const;

 private:
  static constexpr std::size_t kMessageSize = 128;

  void TakeAsked(const PlantSensors& sensors, types::RobotState state,
                 const PlantCommand* asked) noexcept;
  leg::LegAngles AnglesOf(const GuardedLeg& leg,
                          const types::JointArray<double>& position_rad) const noexcept;
  void Find() noexcept;
  template <class... Values>
  void Write(const char* format, Values... values) noexcept;

  FallGuardConfig config_;
  double period_s_;
  fall::FallDetector detector_;
  fall::FallOutput output_;
  bool asking_ = false;                    // the robot may move
  types::JointArray<double> asked_rad_{};  // q_r, while asking_
  bool right_carries_ = true;              // of the last tick in which a foot carried anything
  double reference_height_m_ = 0.0;
  double unwatched_s_ = 0.0;  // how long the robot may move without the detector
  bool fallen_ = false;
  std::array<char, kMessageSize> message_{};
  std::size_t message_size_ = 0;
};

}  // namespace sinew::provider
