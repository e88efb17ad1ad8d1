// Why the robot has a fault: cause, what was measured, the limit it passed, and what to do. Pure.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace sinew::provider {

enum class FaultCause {
  kNone,
  kCommandMissing,    // value and limit: ms since the tick that the newest command answers
  kCycleLate,         // value and limit: ms between the begins of two cycles
  kCommandNotFinite,  // value: the joint
  kCommandJoints,     // value: the joints that a command names; limit: those of the robot
  kCommandNames,      // value: the joint that the controller names otherwise
  kPlant,             // the plant's message says why
  kJoints,            // a joint's, or of all joints; the plant's message
  kFall,              // the fall guard's message
};

constexpr double Milliseconds(std::chrono::nanoseconds time) {
  return 1e-6 * static_cast<double>(time.count());
}

struct Fault {
  FaultCause cause = FaultCause::kNone;
  double value = 0.0, limit = 0.0;
};

// "joint_command missing for 62 ms, limit 60 ms: ...", and what the plant or the fall guard reports
// (message), which is all of it where there is no other cause. Allocates.
std::string TextOf(const Fault& fault, std::string_view message);

}  // namespace sinew::provider
