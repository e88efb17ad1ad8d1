#include "components/record/logger/player/pace.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::logger {

namespace {

double Checked(double rate) {
  if (rate == kMaxRate || (std::isfinite(rate) && rate >= kLeastRate)) return rate;
  throw std::invalid_argument("rate " + std::to_string(rate) +
                              ", expected at least 0.1 times real time, or max");
}

}  // namespace

Pace::Pace(double rate) : rate_(Checked(rate)) {}

std::int64_t Pace::PositionAt(std::int64_t wall_ns) const {
  if (paused_ || rate_ == kMaxRate) return position_ns_;
  const double passed_ns = static_cast<double>(std::max<std::int64_t>(0, wall_ns - wall_ns_));
  return position_ns_ + static_cast<std::int64_t>(passed_ns * rate_);
}

std::optional<std::int64_t> Pace::DueAt(std::int64_t position_ns, std::int64_t wall_ns) const {
  if (paused_) return std::nullopt;
  if (rate_ == kMaxRate) return wall_ns;
  const double left_ns = static_cast<double>(position_ns - position_ns_);
  return wall_ns_ + static_cast<std::int64_t>(left_ns / rate_);
}

void Pace::JumpTo(std::int64_t position_ns, std::int64_t wall_ns) {
  position_ns_ = position_ns;
  wall_ns_ = wall_ns;
}

void Pace::SetRate(double rate, std::int64_t wall_ns) {
  const double checked = Checked(rate);
  JumpTo(PositionAt(wall_ns), wall_ns);
  rate_ = checked;
}

void Pace::Pause(std::int64_t wall_ns) {
  JumpTo(PositionAt(wall_ns), wall_ns);
  paused_ = true;
}

void Pace::Resume(std::int64_t wall_ns) {
  if (!paused_) return;
  paused_ = false;
  wall_ns_ = wall_ns;
}

}  // namespace sinew::logger
