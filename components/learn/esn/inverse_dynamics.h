// Stand-in for the networks: the drive torque that a motion needs, from the grey-box model.
//
//     torque = -(inertia + passive terms) of the model file at (q, v, a) and the measured pressure,
//              load, payload and temperature (JointModel::RequiredDriveTorque)
//
// Motion. Computed torque: q and v of the reference, or the measured ones (MotionState), and
//
//     a = a_ref + Kp (q_ref - q_measured) + Kd (v_ref - v_measured)                         (1)
//
// Kp, 1/s^2, and Kd, 1/s, are 0 unless stated: then feedback is the controller's, at the torque
// (thesis Figs. 6.19 and 7.6: the reference's acceleration, PD or PID beside the prediction). With
// both and measured q, v it is computed torque in its textbook form (Spong, Hutchinson, Vidyasagar:
// Robot Modeling and Control (2006), 8.3).
//
// Rigid bodies. On a fixed base each joint's own terms (link_inertia, gravity). With a stance,
// those of the whole robot by components/bodies/stance, as the term rigid_body of each joint, which
// is added with share 1 where the model does not state it. Driven joints are those with an effort
// above 0 in the URDF: the model names all. Others (the toe of an elastic sole) rest at 0.
//
// Terms that jump with the sign of velocity are smoothed: below smoothing_rad_s the torque lies on
// the straight line between those at -smoothing_rad_s and +smoothing_rad_s. The motor is taken as
// rigidly geared.
//
// One thread. No memory is taken in Step.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "components/bodies/stance/double_support.h"
#include "components/learn/esn/predictor.h"
#include "components/learn/esn/signals.h"
#include "components/model/actuator/model.h"

namespace sinew::esn {

enum class MotionState { kReference, kMeasured };  // q and v of the prediction

struct StanceConfig {
  arm::Chain chain;
  stance::DoubleSupportConfig soles;
};

struct InverseDynamicsConfig {
  actuator::RobotModel robot;
  double smoothing_rad_s = 0.05;
  MotionState state = MotionState::kReference;
  double proportional_1_s2 = 0.0;  // Kp of (1)
  double derivative_1_s = 0.0;     // Kd
  std::optional<StanceConfig> stance;
};

class InverseDynamics {
 public:
  // Throws std::invalid_argument: no joints or too many, smoothing not above 0, gains below 0; with
  // a stance a joint that the robot lacks or the model, terms of the model that are part of the
  // rigid bodies, and what DoubleSupport refuses.
  explicit InverseDynamics(const InverseDynamicsConfig& config);
  InverseDynamics(const actuator::RobotModel& robot, double smoothing_rad_s)
      : InverseDynamics(InverseDynamicsConfig{
            .robot = robot, .smoothing_rad_s = smoothing_rad_s, .stance = std::nullopt}) {}

  void Reset() noexcept;
  // A joint without a motion, or with a torque that is not finite, is not valid; with a stance one
  // such joint leaves none valid. Signals that the robot does not measure count as 0 (temperature:
  // 25 degrees).
  Prediction Step(const Frame& frame, double period_s) noexcept;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

  int joint_count() const noexcept { return static_cast<int>(joints_.size()); }
  // Solution of the last Step; null without a stance.
  const stance::DoubleSupportSolution* stance() const noexcept {
    return stance_ ? &stance_->result() : nullptr;
  }

 private:
  struct Joint {
    actuator::JointModel model;
    std::vector<double> memory;
    bool started = false;
    Eigen::Index of_robot = -1;  // among the joints of the stance's robot

    void Exchange(types::StateArchive& archive);
  };
  struct Motion {
    double q = 0.0, v = 0.0, a = 0.0;
    bool finite() const noexcept;
  };

  void AddStance(const StanceConfig& config);
  void CheckDriven(const arm::Chain& chain) const;
  Motion MotionOf(const Frame& frame, int joint) const noexcept;
  // Torques of the rigid bodies; false: there are none.
  bool SolveStance(const Frame& frame) noexcept;

  std::vector<Joint> joints_;
  double smoothing_rad_s_;
  MotionState state_;
  double proportional_1_s2_, derivative_1_s_;
  std::optional<stance::DoubleSupport> stance_;
  Eigen::VectorXd q_, v_, a_;  // of the robot's joints
};

}  // namespace sinew::esn
