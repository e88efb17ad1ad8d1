#include "components/robot/provider/fault.h"

#include <cstdio>

namespace sinew::provider {

std::string TextOf(const Fault& fault, std::string_view message) {
  char text[200] = "";
  switch (fault.cause) {
    case FaultCause::kNone:
    case FaultCause::kPlant:
    case FaultCause::kJoints:
    case FaultCause::kFall:
      return std::string(message);
    case FaultCause::kCommandMissing:
      std::snprintf(text, sizeof text,
                    "joint_command missing for %.0f ms, limit %.0f ms: is the controller alive "
                    "('sinew list'), is this host fit for real time ('sinew doctor')?",
                    fault.value, fault.limit);
      break;
    case FaultCause::kCycleLate:
      std::snprintf(text, sizeof text,
                    "this provider's cycle began %.0f ms after the last, limit %.0f ms: see "
                    "'sinew doctor' for what keeps a process from its times",
                    fault.value, fault.limit);
      break;
    case FaultCause::kCommandNotFinite:
      std::snprintf(text, sizeof text,
                    "joint_command of joint %.0f is not a finite number: the controller's log "
                    "says why",
                    fault.value);
      break;
    case FaultCause::kCommandJoints:
      std::snprintf(text, sizeof text,
                    "joint_command names %.0f joints and this robot has %.0f: the controller is "
                    "configured for another robot",
                    fault.value, fault.limit);
      break;
    case FaultCause::kCommandNames:
      std::snprintf(text, sizeof text,
                    "joint %.0f has another name in the controller's configuration than here: it "
                    "is configured for another robot, or its joints stand in another order",
                    fault.value);
      break;
  }
  return message.empty() ? text : text + ("; " + std::string(message));
}

}  // namespace sinew::provider
