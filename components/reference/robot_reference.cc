#include "components/reference/robot_reference.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/types/joints.h"

namespace sinew::reference {

RobotReference::RobotReference(const RobotReferenceConfig& config)
    : start_(config.start), start_delay_s_(config.start_delay_s) {
  if (config.joints.empty() || config.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument(std::to_string(config.joints.size()) + " joints, expected 1 to " +
                                std::to_string(types::kMaxJoints));
  }
  if (!(config.start_delay_s >= 0.0) || !std::isfinite(config.start_delay_s)) {
    throw std::invalid_argument("start delay is negative or not finite");
  }
  for (const GeneratorConfig& joint : config.joints) joints_.emplace_back(joint);
}

RobotReferenceOutput RobotReference::Step(const RobotReferenceInput& input) noexcept {
  if (input.session_id != session_id_) {
    session_id_ = input.session_id;
    moving_ = asked_ = running_ = false;
  }
  const int count = std::min<int>(static_cast<int>(joints_.size()), input.joint_count);
  RobotReferenceOutput output;
  output.joint_count = static_cast<int>(joints_.size());
  for (int j = 0; j < count; ++j) output.joint[j].position_rad = input.position_rad[j];

  if (!input.may_move || input.operator_stop) {
    moving_ = input.may_move;
    asked_ = running_ = false;
    allowed_tick_ = UINT64_MAX;  // stopped until it is armed or asked again
    allowed_tick_ = UINT64_MAX;  // stopped for good
    return output;
  }
  if (!moving_) {
    moving_ = true;
    allowed_tick_ = start_ == StartRule::kArmed ? input.tick : UINT64_MAX;
  }
  if (input.operator_start && !asked_) {
    asked_ = true;
    allowed_tick_ = input.tick;
  }

  if (!running_) {
    if (input.tick < allowed_tick_) return output;
    const double waited_s = static_cast<double>(input.tick - allowed_tick_) * input.period_s;
    if (waited_s < start_delay_s_) return output;
    bool all_known = count == static_cast<int>(joints_.size());
    for (int j = 0; j < count; ++j) {
      all_known = all_known && input.valid[j] && std::isfinite(input.position_rad[j]);
    }
    if (!all_known) {  // where it stands is not known: it cannot start from there
      output.stale = true;
      return output;
    }
    running_ = true;
    start_tick_ = input.tick;
    double longest_s = 0.0;
    for (int j = 0; j < count; ++j) {
      joints_[j].Start(input.position_rad[j]);
      longest_s = std::max(longest_s, joints_[j].soft_start_s());
    }
    for (Generator& joint : joints_) joint.LengthenSoftStart(longest_s);
  }

  const double time_s = static_cast<double>(input.tick - start_tick_) * input.period_s;
  output.idle = false;
  output.finished = true;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    output.joint[j] = joints_[j].At(time_s);
    output.finished = output.finished && joints_[j].Finished(time_s);
  }
  return output;
}

}  // namespace sinew::reference
