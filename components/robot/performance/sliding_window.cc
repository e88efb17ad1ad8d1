#include "components/robot/performance/sliding_window.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::performance {
namespace {

WindowSum Joined(const WindowSum& a, const WindowSum& b) noexcept {
  return {a.sum + b.sum, std::min(a.smallest, b.smallest), std::max(a.largest, b.largest),
          a.count + b.count};
}

}  // namespace

bool IsUsable(double value) noexcept { return std::abs(value) <= kMaxMagnitude; }

int TicksOf(double duration_s, double period_s) {
  const double ticks = std::floor(duration_s / period_s + 1e-9);
  if (!(period_s > 0.0) || !(duration_s >= 0.0) || !(ticks <= 1e7)) {
    throw std::invalid_argument(
        "a positive period and a time of at most 10^7 of it are needed, got " +
        std::to_string(duration_s) + " s in periods of " + std::to_string(period_s) + " s");
  }
  return static_cast<int>(ticks);
}

SlidingWindow::SlidingWindow(int size) {
  if (size < 1) {
    throw std::invalid_argument("a window has at least one tick, not " + std::to_string(size));
  }
  slots_.resize(static_cast<std::size_t>(size));
}

void SlidingWindow::PushSlot(const WindowSum& slot) noexcept {
  if (next_ == slots_.size()) {
    for (std::size_t i = slots_.size() - 1; i > 0; --i) {
      slots_[i - 1] = Joined(slots_[i - 1], slots_[i]);
    }
    next_ = 0;
    prefix_ = WindowSum{};
  }
  slots_[next_++] = slot;
  prefix_ = Joined(prefix_, slot);
}

void SlidingWindow::Push(double value) noexcept {
  PushSlot(IsUsable(value) ? WindowSum{value, value, value, 1} : WindowSum{});
}

void SlidingWindow::PushLost(std::uint64_t ticks) noexcept {
  if (ticks >= slots_.size()) {
    Clear();
    return;
  }
  for (std::uint64_t i = 0; i < ticks; ++i) PushSlot(WindowSum{});
}

void SlidingWindow::Clear() noexcept {
  std::fill(slots_.begin(), slots_.end(), WindowSum{});
  next_ = 0;
  prefix_ = WindowSum{};
}

WindowSum SlidingWindow::Sum() const noexcept {
  return next_ < slots_.size() ? Joined(slots_[next_], prefix_) : prefix_;
}

}  // namespace sinew::performance
