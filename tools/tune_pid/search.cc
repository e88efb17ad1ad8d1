#include "tools/tune_pid/search.h"

#include <random>
#include <stdexcept>
#include <string>

namespace sinew::tune {
namespace {

void CheckRange(const char* name, const GainRange& range) {
  if (range.lower > 0.0 && range.lower <= range.upper && std::isfinite(range.upper)) return;
  throw std::invalid_argument(std::string(name) + ": range " + std::to_string(range.lower) +
                              " .. " + std::to_string(range.upper) +
                              ", expected 0 < lower <= upper");
}

}  // namespace

std::optional<Draw> SearchGains(const SearchConfig& config, const control::PidConfig& rest,
                                const TrialCost& cost,
                                const std::function<void(const Draw&)>& better) {
  if (config.trials < 1) {
    throw std::invalid_argument("trials: " + std::to_string(config.trials) +
                                ", expected 1 or more");
  }
  CheckRange("proportional", config.proportional);
  CheckRange("integral", config.integral);
  CheckRange("derivative", config.derivative);
  CheckRange("around_best", config.around_best);
  std::mt19937_64 random(config.seed);
  const auto draw = [&random](const GainRange& range) {
    const double u = static_cast<double>(random() >> 11) * 0x1.0p-53;
    return range.lower * std::pow(range.upper / range.lower, u);
  };
  Draw best{.pid = rest};
  for (int stage = 1; stage <= 2; ++stage) {
    const control::PidConfig center = best.pid;
    for (int i = 0; i < config.trials; ++i) {
      control::PidConfig pid = rest;
      if (stage == 1) {
        pid.proportional_Nm_rad = draw(config.proportional);
        pid.integral_Nm_rad_s = draw(config.integral);
        pid.derivative_Nm_s_rad = draw(config.derivative);
      } else {
        pid.proportional_Nm_rad = center.proportional_Nm_rad * draw(config.around_best);
        pid.integral_Nm_rad_s = center.integral_Nm_rad_s * draw(config.around_best);
        pid.derivative_Nm_s_rad = center.derivative_Nm_s_rad * draw(config.around_best);
      }
      const double found = cost(pid, best.cost);
      if (!(found < best.cost)) continue;
      best = {stage, i, pid, found};
      if (better) better(best);
    }
  }
  if (best.stage == 0) return std::nullopt;
  return best;
}

double TrackingCost(const ClosedLoopScore& score) noexcept {
  return score.faulted || score.fell_at_s ? kDiscarded : score.mse_rad2;
}

}  // namespace sinew::tune
