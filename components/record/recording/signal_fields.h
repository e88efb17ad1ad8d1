// Fields of topics that carry the signals. Bit i of actuator_state.measured_flags says that the
// robot measures signal i (docs/formats.md has the table for people; a test compares the two).
#pragma once

#include <string_view>
#include <vector>

#include "components/base/types/signal.h"

namespace sinew::recording {

struct SignalField {
  types::Signal signal{};
  std::string_view topic;
  std::string_view field;  // an array over the joints
};

const std::vector<SignalField>& SignalFields();

// Signals that only CSV files have: no topic carries the supply.
inline constexpr bool OnTopics(types::Signal signal) {
  return signal != types::Signal::kSupplyVoltage;
}

}  // namespace sinew::recording
