// The imposed pressures (sim_pressure) that act on a simulated plant.
//
// As valve commands: of the running session only, not from the future, and no longer than
// fault_after; nothing is imposed on a robot in FAULT or ESTOPPED. Pure, of one thread, no
// allocation.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "components/base/types/message_header.h"
#include "components/robot/provider/simulated_plant.h"

namespace sinew::provider {

// A sim_pressure, decoded. Entries from joint_count on are not imposed.
struct PressureMessage {
  types::MessageHeader header{.origin = types::Origin::kSim};
  int joint_count = 0;
  ImposedPressure pressure;
};

class PressureSource {
 public:
  PressureSource(std::uint64_t session_id, std::chrono::nanoseconds period,
                 std::chrono::nanoseconds fault_after)
      : session_id_(session_id), period_(period), fault_after_(fault_after) {}

  // True: it counts from here on.
  bool Take(const PressureMessage& message, std::uint64_t tick) noexcept;
  // The pressures that act in this tick. stopped: the robot is in FAULT or ESTOPPED.
  ImposedPressure Current(std::uint64_t tick, bool stopped) const noexcept;
  // One more than the newest tick under the session that was answered; 0: none.
  std::uint64_t answers() const noexcept { return answers_; }

 private:
  std::uint64_t session_id_;
  std::chrono::nanoseconds period_, fault_after_;
  std::optional<PressureMessage> last_;
  std::uint64_t answers_ = 0;
};

}  // namespace sinew::provider
