#include "components/robot/pneumatics/relay.h"

#include <cmath>
#include <stdexcept>

namespace sinew::pneumatics {

Relay::Relay(const RelayTimes& times) : times_(times), since_s_(times.min_off_s) {
  if (!(times.min_on_s >= 0.0) || !(times.min_off_s >= 0.0) || !std::isfinite(times.min_on_s) ||
      !std::isfinite(times.min_off_s)) {
    throw std::invalid_argument("least time of a relay is negative or not finite");
  }
}

bool Relay::Step(bool wanted, double period_s) noexcept {
  since_s_ += period_s;
  // Half a period of slack: sums of periods are not exact.
  const double least_s = (on_ ? times_.min_on_s : times_.min_off_s) - 0.5 * period_s;
  if (wanted != on_ && since_s_ >= least_s) Force(wanted);
  return on_;
}

void Relay::Force(bool on) noexcept {
  if (on == on_) return;
  on_ = on;
  since_s_ = 0.0;
  ++switches_;
}

}  // namespace sinew::pneumatics
