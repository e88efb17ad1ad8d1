#include "components/robot/reference/robot_reference.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::reference {

bool AllFinite(const RobotReferenceOutput& output) noexcept {
  return std::all_of(output.joint.begin(), output.joint.end(), [](const Point& point) {
    return std::isfinite(point.position_rad) && std::isfinite(point.velocity_rad_s) &&
           std::isfinite(point.acceleration_rad_s2);
  });
}

RobotReference::RobotReference(const RobotReferenceConfig& config)
    : start_(config.start), start_delay_s_(config.start_delay_s), hold_s_(config.hold_s) {
  if (config.joints.empty() || config.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument(std::to_string(config.joints.size()) + " joints, expected 1 to " +
                                std::to_string(types::kMaxJoints));
  }
  if (!(config.start_delay_s >= 0.0) || !std::isfinite(config.start_delay_s)) {
    throw std::invalid_argument("start delay is negative or not finite");
  }
  if (!(config.hold_s >= 0.0) || !std::isfinite(config.hold_s)) {
    throw std::invalid_argument("hold is negative or not finite");
  }
  for (const GeneratorConfig& joint : config.joints) joints_.emplace_back(joint);
}

// All joints have started; they reach their trajectories together.
void RobotReference::Begin(std::uint64_t tick) noexcept {
  running_ = true;
  holding_ = false;
  start_tick_ = tick;
  double longest_s = 0.0;
  for (const Generator& joint : joints_) longest_s = std::max(longest_s, joint.soft_start_s());
  for (Generator& joint : joints_) joint.LengthenSoftStart(longest_s);
}

void RobotReference::TakeOver(const RobotReferenceOutput& other,
                              const RobotReferenceInput& input) noexcept {
  session_id_ = input.session_id;
  moving_ = input.may_move;
  asked_ = running_ = holding_ = false;
  allowed_tick_ = UINT64_MAX;
  if (!input.may_move || other.idle) return;
  bool at_rest = true;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    at_rest = at_rest && other.joint[j].velocity_rad_s == 0.0 &&
              other.joint[j].acceleration_rad_s2 == 0.0;
  }
  if (at_rest) {
    holding_ = true;
    held_ = other.joint;
    return;
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j].Start(other.joint[j]);
  Begin(input.tick);
}

RobotReferenceOutput RobotReference::Step(const RobotReferenceInput& input) noexcept {
  if (input.session_id != session_id_) {
    session_id_ = input.session_id;
    moving_ = asked_ = running_ = holding_ = false;
  }
  const int count = std::min<int>(static_cast<int>(joints_.size()), input.joint_count);
  RobotReferenceOutput output;
  output.joint_count = static_cast<int>(joints_.size());
  for (int j = 0; j < count; ++j) {
    if (std::isfinite(input.position_rad[j])) {
      output.joint[j].position_rad = input.position_rad[j];
    }
  }

  if (!input.may_move || input.operator_stop) {
    moving_ = input.may_move;
    asked_ = running_ = holding_ = false;
    allowed_tick_ = UINT64_MAX;  // stopped until it is armed or asked again
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
    if (input.tick < allowed_tick_) {
      if (holding_) {
        output.joint = held_;
        output.idle = false;
        output.finished = true;
      }
      return output;
    }
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
    if (waited_s < start_delay_s_ + hold_s_) {
      if (!holding_) held_ = output.joint;
      holding_ = true;
      output.joint = held_;
      output.idle = false;
      return output;
    }
    for (int j = 0; j < count; ++j) {
      joints_[j].Start(holding_ ? held_[j].position_rad : input.position_rad[j]);
    }
    Begin(input.tick);
  }

  const double time_s = static_cast<double>(input.tick - start_tick_) * input.period_s;
  RobotReferenceOutput moving = output;
  moving.idle = false;
  moving.finished = true;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    moving.joint[j] = joints_[j].At(time_s);
    moving.finished = moving.finished && joints_[j].Finished(time_s);
  }
  if (AllFinite(moving)) return moving;
  asked_ = running_ = holding_ = false;
  allowed_tick_ = UINT64_MAX;
  output.stale = true;
  return output;
}

}  // namespace sinew::reference
