// Which field of which topic carries which signal. Bit i of actuator_state.measured_flags says that
// the robot measures signal i (docs/formats.md has the table for people; a test compares the two).
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "components/identify/run.h"

namespace sinew::recording {

struct SignalField {
  identify::Signal signal{};
  std::string_view topic;
  std::string_view field;  // an array over the joints
};

const std::vector<SignalField>& SignalFields();

// Signals that only CSV files have: no topic carries the supply.
inline constexpr bool OnTopics(identify::Signal signal) {
  return signal != identify::Signal::kSupplyVoltage;
}

inline constexpr std::uint32_t SignalBit(identify::Signal signal) {
  return std::uint32_t{1} << static_cast<unsigned>(signal);
}

}  // namespace sinew::recording
