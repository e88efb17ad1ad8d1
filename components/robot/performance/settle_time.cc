#include "components/robot/performance/settle_time.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::performance {

SettleTime::SettleTime(const SettleConfig& config, double period_s)
    : config_(config),
      period_s_(period_s),
      hold_ticks_(static_cast<std::uint64_t>(TicksOf(config.hold_s, period_s))),
      bridge_ticks_(static_cast<std::uint64_t>(TicksOf(config.bridge_s, period_s))),
      window_(static_cast<int>(hold_ticks_) + 1) {
  if (!(config.band > 0.0) || !std::isfinite(config.band)) {
    throw std::invalid_argument("band is positive, got " + std::to_string(config.band));
  }
  if (hold_ticks_ == 0 || hold_ticks_ < 2 * bridge_ticks_) {
    throw std::invalid_argument("hold_s is at least a period and twice bridge_s, got " +
                                std::to_string(config.hold_s));
  }
  if (config.plateau && !IsUsable(*config.plateau)) {
    throw std::invalid_argument("plateau is a number, got " + std::to_string(*config.plateau));
  }
}

void SettleTime::Event(std::uint64_t tick) noexcept {
  result_ = SettleResult{};
  result_.state = SettleResult::State::kNotSettled;
  started_ = false;
  event_tick_ = next_tick_ = sample_tick_ = tick;
  StartSearch(tick);
}

void SettleTime::StartSearch(std::uint64_t tick) noexcept {
  search_tick_ = tick;
  window_.Clear();
}

SettleResult SettleTime::Step(std::uint64_t tick, double value) noexcept {
  if (result_.state == SettleResult::State::kNoEvent || tick < next_tick_) return result_;
  const std::uint64_t missing = tick - next_tick_;
  next_tick_ = tick + 1;
  result_.lost_ticks += missing;
  window_.PushLost(missing);
  if (!IsUsable(value)) {
    ++result_.lost_ticks;
    window_.PushLost(1);
    return result_;
  }
  const bool settled = result_.state == SettleResult::State::kSettled;
  // The ticks without a sample between the last one (or the event) and this one.
  const std::uint64_t unseen = tick - sample_tick_ - (started_ && tick > sample_tick_ ? 1 : 0);
  if (!settled && unseen > bridge_ticks_) StartSearch(tick);
  started_ = true;
  sample_tick_ = tick;
  window_.Push(value);
  const std::optional<double> plateau =
      settled ? std::optional<double>(result_.plateau) : config_.plateau;
  if (plateau && std::abs(value - *plateau) > config_.band) {
    if (settled) ++result_.departures;
    result_.state = SettleResult::State::kNotSettled;
    // With a given plateau nothing up to here counts; an estimated one may be met by the window.
    search_tick_ = config_.plateau ? tick + 1 : search_tick_;
    return result_;
  }
  if (!settled) Search(tick);
  return result_;
}

void SettleTime::Search(std::uint64_t tick) noexcept {
  if (tick < search_tick_ + hold_ticks_) return;
  if (config_.plateau) {
    result_.plateau = *config_.plateau;
    result_.settle_s = static_cast<double>(search_tick_ - event_tick_) * period_s_;
  } else {
    const WindowSum sum = window_.Sum();
    const double mean = sum.sum / sum.count;
    if (sum.largest - mean > config_.band || mean - sum.smallest > config_.band) return;
    result_.plateau = mean;
    result_.settle_s = static_cast<double>(tick - hold_ticks_ - event_tick_) * period_s_;
  }
  result_.state = SettleResult::State::kSettled;
}

}  // namespace sinew::performance
