// Why a robot, or one of its joints, may not move: an enumerated cause, what was measured, the
// limit it passed, and what to do. The causes are those of idl/fault.idl.
//
// Pure; any thread. FaultText allocates.
#pragma once

#include <sinew_idl/fault.h>

#include <string>
#include <string_view>

namespace sinew::types {

using msg::FaultCause;
inline constexpr int kFaultCauses = static_cast<int>(CountOf(FaultCause{}));

inline constexpr int kWholeRobot = 255;

struct Fault {
  FaultCause cause = FaultCause::kNone;
  int joint = kWholeRobot;  // index
  double value = 0.0;       // in the unit of the cause
  double limit = 0.0;       // which the value passed; as the value where the cause has none

  bool active() const { return cause != FaultCause::kNone; }
  bool operator==(const Fault&) const = default;
};

// As a message says it, and back.
msg::Fault ToMessage(const Fault& fault) noexcept;
Fault FromMessage(const msg::Fault& message) noexcept;

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
