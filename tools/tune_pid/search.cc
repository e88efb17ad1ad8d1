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

std::vector<control::PidConfig> DrawStage(const SearchConfig& config, int stage,
                                          const control::PidConfig& center) {
  if (config.trials < 1) {
    throw std::invalid_argument("trials: " + std::to_string(config.trials) +
                                ", expected 1 or more");
  }
  if (stage != 1 && stage != 2) {
    throw std::invalid_argument("stage: " + std::to_string(stage) + ", expected 1 or 2");
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
  // One sequence for both stages, three numbers a draw.
  if (stage == 2) random.discard(3ULL * static_cast<unsigned long long>(config.trials));
  std::vector<control::PidConfig> draws(static_cast<std::size_t>(config.trials), center);
  for (control::PidConfig& pid : draws) {
    if (stage == 1) {
      pid.proportional_Nm_rad = draw(config.proportional);
      pid.integral_Nm_rad_s = draw(config.integral);
      pid.derivative_Nm_s_rad = draw(config.derivative);
    } else {
      for (const Gain& gain : kGains) pid.*gain.of *= draw(config.around_best);
    }
  }
  return draws;
}

std::optional<Draw> SearchGains(const SearchConfig& config, const control::PidConfig& rest,
                                const TrialCost& cost,
                                const std::function<void(const Draw&)>& better) {
  Draw best{.pid = rest};
  for (int stage = 1; stage <= 2; ++stage) {
    // Without a best, stage 2 would be around `rest`, which nobody asked for.
    if (stage == 2 && best.stage == 0) return std::nullopt;
    const std::vector<control::PidConfig> draws = DrawStage(config, stage, best.pid);
    for (std::size_t i = 0; i < draws.size(); ++i) {
      const double found = cost(draws[i], best.cost);
      if (!(found < best.cost)) continue;
      best = {stage, static_cast<int>(i), draws[i], found};
      if (better) better(best);
    }
  }
  return best;
}

double TrackingCost(const ClosedLoopScore& score) noexcept {
  return score.faulted || score.fell_at_s ? kDiscarded : score.mse_rad2;
}

}  // namespace sinew::tune
