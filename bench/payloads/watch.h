// What a participant publishes: it decodes and has meaning, its numbers are finite, and commands
// are within limits. Thread: one.
#pragma once

#include <string>
#include <string_view>

#include "components/topics/node/codec.h"

namespace sinew::payloads {

// Of robots/rig/surrogate_model.yaml, rounded up.
inline constexpr double kMotorTorqueLimit_Nm = 0.3981;

// What is wrong with a published payload; empty: nothing.
std::string Assess(std::string_view topic, const node::Bytes& payload);

}  // namespace sinew::payloads
