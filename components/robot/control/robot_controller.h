// All joints of a robot, tick by tick. A latched fault of one joint switches every joint off.
// Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <span>
#include <vector>

#include "components/robot/control/joint_controller.h"
#include "components/robot/control/types.h"

namespace sinew::control {

class RobotController {
 public:
  // Throws std::invalid_argument for 0 or more than kMaxJoints joints, or a bad joint.
  explicit RobotController(const std::vector<JointControlConfig>& joints);

  RobotOutput Step(const RobotInput& input) noexcept;
  // See JointController::Follow; a value per joint.
  void Follow(std::span<const double> difference_motor_torque_Nm) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  int joint_count() const noexcept { return static_cast<int>(joints_.size()); }

 private:
  std::vector<JointController> joints_;
  std::uint64_t session_id_ = 0;
  bool session_known_ = false;
  int reference_count_ = 0;  // when last heard
};

}  // namespace sinew::control
