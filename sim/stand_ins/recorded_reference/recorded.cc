#include "sim/stand_ins/recorded_reference/recorded.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::stand_ins {
namespace {

// A time this share of a step away from a sample is that sample's: far above the rounding of
// tick * period, far below any difference of period that matters.
constexpr double kSameTime_share = 1e-6;

reference::Point StraightOn(const reference::Point& from, double time_s) {
  return {from.position_rad + from.velocity_rad_s * time_s, from.velocity_rad_s, 0.0};
}

double Between(double from, double to, double share) { return from + share * (to - from); }

}  // namespace

Recorded::Recorded(std::vector<double> time_s, std::vector<reference::Point> points)
    : time_s_(std::move(time_s)), points_(std::move(points)) {
  if (time_s_.size() < 2 || time_s_.size() != points_.size()) {
    throw std::invalid_argument(std::to_string(points_.size()) + " points at " +
                                std::to_string(time_s_.size()) +
                                " times, expected two or more, as many as times");
  }
  const double first_s = time_s_.front();
  for (std::size_t i = 0; i < time_s_.size(); ++i) {
    time_s_[i] -= first_s;
    const reference::Point& p = points_[i];
    if (!std::isfinite(time_s_[i]) || (i > 0 && !(time_s_[i] > time_s_[i - 1]))) {
      throw std::invalid_argument("sample " + std::to_string(i) + ": time " +
                                  std::to_string(time_s_[i]) + " s, expected after the last one");
    }
    if (!std::isfinite(p.position_rad) || !std::isfinite(p.velocity_rad_s) ||
        !std::isfinite(p.acceleration_rad_s2)) {
      throw std::invalid_argument("sample " + std::to_string(i) + " is not finite");
    }
  }
}

reference::Point Recorded::At(double time_s) const noexcept {
  if (!(time_s >= 0.0)) return StraightOn(points_.front(), time_s);
  if (time_s > time_s_.back()) return StraightOn(points_.back(), time_s - time_s_.back());
  const auto after = std::upper_bound(time_s_.begin(), time_s_.end(), time_s);
  const auto next = static_cast<std::size_t>(after - time_s_.begin());
  if (next == time_s_.size()) return points_.back();
  const double share = (time_s - time_s_[next - 1]) / (time_s_[next] - time_s_[next - 1]);
  const reference::Point& from = points_[next - 1];
  const reference::Point& to = points_[next];
  if (share < kSameTime_share) return from;
  if (share > 1.0 - kSameTime_share) return to;
  return {Between(from.position_rad, to.position_rad, share),
          Between(from.velocity_rad_s, to.velocity_rad_s, share),
          Between(from.acceleration_rad_s2, to.acceleration_rad_s2, share)};
}

}  // namespace sinew::stand_ins
