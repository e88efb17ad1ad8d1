#include "components/robot/reference/standby.h"

namespace sinew::reference {

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
