#include "components/robot/reference/standby.h"

#include <algorithm>

namespace sinew::reference {

namespace {

// For as long the owner's last points say where the motion is. Readers bear the silence of an owner
// for 20 ms or five periods (ownership.h), and a standby that stalled for as long stands by for
// five periods more: twice the sum at 100 Hz and above. The rig's published motion (jerk 8.3
// rad/s^3) leaves its parabola by 11 mrad in that time, and by radians in seconds.
constexpr double kKnown_s = 0.2, kKnownPeriods = 20.0;

}  // namespace

void Standby::Follow(std::uint64_t tick, const RobotReferenceOutput& owner) noexcept {
  if (!AllFinite(owner)) return;
  owner_ = owner;
  owner_tick_ = tick;
  follows_ = true;
}

RobotReferenceOutput Standby::CarriedOn(const RobotReferenceInput& input) const noexcept {
  RobotReferenceOutput output = owner_;
  if (output.idle || input.tick <= owner_tick_) return output;
  const double time_s = static_cast<double>(input.tick - owner_tick_) * input.period_s;
  if (time_s > std::max(kKnown_s, kKnownPeriods * input.period_s)) return {};
  for (Point& point : output.joint) point = Extrapolated(point, time_s);
  if (!AllFinite(output)) return owner_;
  return output;
}

RobotReferenceOutput Standby::Step(const RobotReferenceInput& input, bool owner_heard) noexcept {
  if (follows_ && owner_heard) return CarriedOn(input);
  if (follows_) {
    follows_ = false;
    own_.TakeOver(CarriedOn(input), input);
  }
  return own_.Step(input);
}

}  // namespace sinew::reference
