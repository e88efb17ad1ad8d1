#include "components/robot/provider/pressure_source.h"

#include <cmath>

#include "components/base/types/command_rule.h"

namespace sinew::provider {

bool PressureSource::Take(const PressureMessage& message, std::uint64_t tick) noexcept {
  if (types::RefusalOf(types::CommandKind::kRequest, message.header,
                       {session_id_, types::Origin::kSim}) != types::CommandRefusal::kNone) {
    return false;
  }
  answers_ = message.header.tick + 1;
  if (message.header.tick > tick) return false;
  last_ = message;
  return true;
}

ImposedPressure PressureSource::Current(std::uint64_t tick, bool stopped) const noexcept {
  ImposedPressure pressure;
  if (!last_ || stopped) return pressure;
  const auto age = static_cast<std::int64_t>(tick - last_->header.tick);
  if (age * period_ > fault_after_) return pressure;
  for (std::size_t j = 0; j < pressure.imposed.size(); ++j) {
    const double asked_bar = last_->pressure.chamber_pressure_bar[j];
    pressure.imposed[j] = static_cast<int>(j) < last_->joint_count && last_->pressure.imposed[j] &&
                          std::isfinite(asked_bar);
    if (pressure.imposed[j]) pressure.chamber_pressure_bar[j] = asked_bar;
  }
  return pressure;
}

}  // namespace sinew::provider
