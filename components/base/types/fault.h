// Why a robot, or one of its joints, may not move: an enumerated cause, what was measured, the
// limit it passed, and what to do. idl/fault.idl has the same causes.
//
// Pure; any thread. FaultText allocates.
#pragma once

#include <string>
#include <string_view>

namespace sinew::types {

enum class FaultCause {
  kNone,
  // the robot's
  kCommandMissing,
  kCycleLate,
  kCommandNotFinite,
  kCommandJoints,
  kCommandNames,
  kFall,
  kPlant,
  // a joint's
  kAxisError,
  kHeartbeatLost,
  kEstimatesLost,
  kNodeLost,
  kEncoderJump,
  kOverTemperature,
  kOverspeed,
  kOutOfRange,
  kNoClosedLoop,
  kZero,
  kNotFinite,
  kOutputJump,
  kEncoderFrozen,
  kEncoderSlipped,
  kEncodersDisagree,
  kAnotherMaster,
};
inline constexpr int kFaultCauses = static_cast<int>(FaultCause::kAnotherMaster) + 1;

inline constexpr int kWholeRobot = 255;

struct Fault {
  FaultCause cause = FaultCause::kNone;
  int joint = kWholeRobot;  // index
  double value = 0.0;       // in the unit of the cause
  double limit = 0.0;       // which the value passed; as the value where the cause has none

  bool active() const { return cause != FaultCause::kNone; }
  bool operator==(const Fault&) const = default;
};

struct FaultTerms {
  FaultCause cause = FaultCause::kNone;
  std::string_view name;           // "no heartbeat"
  std::string_view unit = "";      // of value and limit; empty: it has none
  int decimals = 0;                // of both
  std::string_view remedy = "";    // "is the drive powered?"
  std::string_view before = ": ";  // the value, in the text
  std::string_view between = ", limit ";
};

const FaultTerms& TermsOf(FaultCause cause);

// "joint 2: no heartbeat for 512 ms, limit 500 ms, bus 'can0' is down: is its power on?": joint,
// name, numbers (unless they are equal), detail and remedy. Empty without a fault.
std::string FaultText(const Fault& fault, std::string_view detail = {});

}  // namespace sinew::types
