#include "components/topics/node/tick_period.h"

#include <algorithm>

namespace sinew::node {

namespace {

// Wraps around where the difference of two signed numbers would overflow.
std::int64_t Difference(std::int64_t later, std::int64_t earlier) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(later) -
                                   static_cast<std::uint64_t>(earlier));
}

}  // namespace

double TickPeriod::Next(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                        bool simulated, double nominal_s) noexcept {
  const std::optional<Cycle> last = last_;
  last_ = Cycle{session_id, tick, stamp_ns};
  if (!(nominal_s > 0.0) || !last || last->session_id != session_id) return nominal_s;
  const double elapsed_s = simulated
                               ? static_cast<double>(tick - last->tick) * nominal_s
                               : static_cast<double>(Difference(stamp_ns, last->stamp_ns)) * 1e-9;
  if (!(elapsed_s > 0.0)) return nominal_s;
  return std::clamp(elapsed_s, kShortestPeriods * nominal_s, kLongestPeriods * nominal_s);
}

}  // namespace sinew::node
