// Stand-in for the networks: the drive torque that the reference motion needs, from the grey-box
// model.
//
//     torque = -(inertia + passive terms) of the model file at (q_ref, dq_ref, ddq_ref) and the
//              measured pressure, load, payload and temperature (JointModel::RequiredDriveTorque)
//
// Terms that jump with the sign of velocity are smoothed: below smoothing_rad_s the torque lies on
// the straight line between those at -smoothing_rad_s and +smoothing_rad_s. The motor is taken as
// rigidly geared.
//
// One thread. No memory is taken in Step.
#pragma once

#include <array>
#include <vector>

#include "components/actuator/model.h"
#include "components/esn/predictor.h"
#include "components/esn/signals.h"

namespace sinew::esn {

class InverseDynamics {
 public:
  // Throws std::invalid_argument: no joints or too many, smoothing not above 0.
  InverseDynamics(const actuator::RobotModel& robot, double smoothing_rad_s);

  void Reset() noexcept;
  // A joint without a reference, or with a torque that is not finite, is not valid. Signals that
  // the robot does not measure count as 0 (temperature: 25 degrees).
  Prediction Step(const Frame& frame, double period_s) noexcept;

  int joint_count() const noexcept { return static_cast<int>(joints_.size()); }

 private:
  struct Joint {
    actuator::JointModel model;
    std::vector<double> memory;
    bool started = false;
  };

  std::vector<Joint> joints_;
  double smoothing_rad_s_;
};

}  // namespace sinew::esn
