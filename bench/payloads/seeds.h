// Well-formed payloads of every topic, from which the mutations start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "components/topics/node/codec.h"

namespace sinew::payloads {

// A period of motion in so many ticks of 240 Hz.
inline constexpr std::size_t kPhases = 64;

// Number of a topic in node::AllTopics().
std::size_t IndexOf(std::string_view topic);

// joint_state of a robot that moves, in one of the five states of types::RobotState.
node::Bytes JointStateSeed(std::size_t phase, std::size_t robot_state);
// The byte that says that the session ends.
std::size_t LastTickOffset();

// Of every topic by its number, at least one each; of joint_state, an armed robot. What
// participants publish is better taken from them: these are then empty messages.
std::vector<std::vector<node::Bytes>> HandmadeSeeds();

}  // namespace sinew::payloads
