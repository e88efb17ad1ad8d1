#include "components/robot/control/follower.h"

namespace sinew::control {

void Follower::Made(std::uint64_t session_id, std::uint64_t tick,
                    const types::JointArray<double>& motor_torque_Nm) noexcept {
  if (session_id != session_id_ || tick <= last_tick_) {
    for (Own& own : own_) own.known = false;
    session_id_ = session_id;
  }
  last_tick_ = tick;
  Own& own = own_[tick % kTicksKept];
  own = {.tick = tick, .known = true, .motor_torque_Nm = motor_torque_Nm, .given_Nm = given_Nm_};
}

std::optional<types::JointArray<double>> Follower::Compare(
    std::uint64_t session_id, std::uint64_t tick,
    const types::JointArray<double>& owner_motor_torque_Nm) noexcept {
  const Own& own = own_[tick % kTicksKept];
  if (session_id != session_id_ || !own.known || own.tick != tick) return std::nullopt;
  types::JointArray<double> give_Nm{};
  for (std::size_t j = 0; j < give_Nm.size(); ++j) {
    const double already_Nm = given_Nm_[j] - own.given_Nm[j];
    give_Nm[j] = owner_motor_torque_Nm[j] - own.motor_torque_Nm[j] - already_Nm;
    given_Nm_[j] += give_Nm[j];
  }
  return give_Nm;
}

}  // namespace sinew::control
