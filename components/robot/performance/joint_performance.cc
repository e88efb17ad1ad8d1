#include "components/robot/performance/joint_performance.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::performance {
namespace {

int WindowTicks(const JointPerformanceConfig& config, double period_s) {
  const int ticks = TicksOf(config.window_s, period_s);
  if (ticks < 1) {
    throw std::invalid_argument("window_s is at least a period, got " +
                                std::to_string(config.window_s));
  }
  return ticks + 1;
}

}  // namespace

JointPerformance::JointPerformance(const JointPerformanceConfig& config, double period_s)
    : squares_(WindowTicks(config, period_s)), energy_(config.motor, period_s, config.bridge_s) {}

JointPerformanceOutput JointPerformance::Step(std::uint64_t tick,
                                              const JointSample& sample) noexcept {
  if (started_ && tick <= last_tick_) {
    ++output_.repeated_ticks;
    return output_;
  }
  const std::uint64_t missing = started_ ? tick - last_tick_ - 1 : 0;
  started_ = true;
  last_tick_ = tick;
  squares_.PushLost(missing);
  output_.error_lost += missing;

  const double error_rad = sample.reference_rad - sample.position_rad;
  const double square_rad2 = error_rad * error_rad;
  squares_.Push(square_rad2);
  output_.error_known = IsUsable(square_rad2);
  output_.error_rad = output_.error_known ? error_rad : 0.0;
  if (output_.error_known) {
    square_sum_.Add(square_rad2);
    ++output_.error_samples;
    output_.mean_square_error_rad2 =
        square_sum_.value() / static_cast<double>(output_.error_samples);
  } else {
    ++output_.error_lost;
  }
  const WindowSum window = squares_.Sum();
  output_.rms_known = window.count > 0;
  output_.sliding_rms_rad = output_.rms_known ? std::sqrt(window.sum / window.count) : 0.0;
  output_.window_share = static_cast<double>(window.count) / squares_.size();

  energy_.Step(tick, sample.torque_Nm, sample.velocity_rad_s, sample.current_A);
  output_.energies = energy_.energies();
  output_.mechanical = energy_.mechanical();
  output_.electrical = energy_.electrical();
  return output_;
}

}  // namespace sinew::performance
