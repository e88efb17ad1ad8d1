// The addition to a standby controller's own state that makes it the owner's.
//
// Both compute a command in every tick; the robot gets the owner's. The owner's command of tick k
// comes after the own one of tick k was made, some ticks later on a loaded machine: it is compared
// with the own command of that same tick, and what was added for earlier ticks in between is not
// added again.
//
// Pure; one thread; allocates nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "components/base/types/joints.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::control {

class Follower {
 public:
  // Later than by this many ticks an owner's command is not compared any more: its deadline is
  // over.
  static constexpr std::size_t kTicksKept = 32;

  // The own command of this tick was made. Another session, or a tick that is not later than the
  // last: everything before it is forgotten.
  void Made(std::uint64_t session_id, std::uint64_t tick,
            const types::JointArray<double>& motor_torque_Nm) noexcept;

  // The owner's command of a tick. What the integrals of the joints are to be given now, as motor
  // torque; nothing when the tick is not among those kept.
  std::optional<types::JointArray<double>> Compare(
      std::uint64_t session_id, std::uint64_t tick,
      const types::JointArray<double>& owner_motor_torque_Nm) noexcept;
  // Exchanges all state but the configuration, to the bit: types/state_archive.h. Reading, throws
  // std::invalid_argument.
  void Exchange(types::StateArchive& archive);

 private:
  struct Own {
    std::uint64_t tick = 0;
    bool known = false;
    types::JointArray<double> motor_torque_Nm{};
    types::JointArray<double> given_Nm{};  // by then, since the start

    void Exchange(types::StateArchive& archive);
  };
  std::array<Own, kTicksKept> own_;
  types::JointArray<double> given_Nm_{};
  std::uint64_t session_id_ = 0;
  std::uint64_t last_tick_ = 0;
};

}  // namespace sinew::control
