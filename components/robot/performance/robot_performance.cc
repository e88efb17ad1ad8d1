#include "components/robot/performance/robot_performance.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace sinew::performance {
namespace {

// One supply for all, so one bridge: the shortest that a joint asks for.
double CommonBridge_s(const RobotPerformanceConfig& config) {
  if (config.joints.empty() || config.joints.size() > std::size_t{types::kMaxJoints}) {
    throw std::invalid_argument("a robot has 1 to " + std::to_string(types::kMaxJoints) +
                                " joints, not " + std::to_string(config.joints.size()));
  }
  double bridge_s = config.joints.front().bridge_s;
  for (const JointPerformanceConfig& joint : config.joints) {
    bridge_s = std::min(bridge_s, joint.bridge_s);
  }
  return bridge_s;
}

void AddTo(Energies* sum, const Energies& joint) noexcept {
  sum->absolute_J += joint.absolute_J;
  sum->positive_J += joint.positive_J;
  sum->net_J += joint.net_J;
  sum->copper_loss_J += joint.copper_loss_J;
  sum->electrical_net_J += joint.electrical_net_J;
  sum->electrical_drawn_J += joint.electrical_drawn_J;
  sum->electrical_known = sum->electrical_known && joint.electrical_known;
}

}  // namespace

RobotPerformance::RobotPerformance(const RobotPerformanceConfig& config, double period_s)
    : drawn_(period_s, CommonBridge_s(config)) {
  if (config.mass_kg) lifting_.emplace(*config.mass_kg, config.lift_band_m);
  joints_.reserve(config.joints.size());
  for (const JointPerformanceConfig& joint : config.joints) joints_.emplace_back(joint, period_s);
}

RobotPerformanceOutput RobotPerformance::Step(std::uint64_t tick,
                                              std::span<const JointSample> samples,
                                              double centre_height_m) noexcept {
  const bool repeated = started_ && tick <= last_tick_;
  started_ = true;
  RobotPerformanceOutput output;
  output.joint_count = static_cast<int>(joints_.size());
  output.energies.electrical_known = true;
  double square_sum_rad2 = 0.0, electrical_W = 0.0;
  int with_error = 0;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const JointSample sample = i < samples.size() ? samples[i] : JointSample{};
    output.joint[i] = joints_[i].Step(tick, sample);
    AddTo(&output.energies, output.joint[i].energies);
    electrical_W += joints_[i].electrical_W();
    if (output.joint[i].error_samples == 0) continue;
    square_sum_rad2 += output.joint[i].mean_square_error_rad2;
    ++with_error;
  }
  if (with_error > 0) output.mean_square_error_rad2 = square_sum_rad2 / with_error;
  if (!repeated) {
    last_tick_ = tick;
    drawn_.Step(tick, electrical_W);
    if (lifting_) lifting_->Step(centre_height_m);
    has_height_ = has_height_ || IsUsable(centre_height_m);
  }
  output.drawn_J = drawn_.positive_J();
  output.drawn = drawn_.coverage();
  if (!lifting_) return output;
  output.lifting_known = has_height_;
  output.rise_m = lifting_->rise_m();
  output.lifting_J = lifting_->work_J();
  return output;
}

}  // namespace sinew::performance
