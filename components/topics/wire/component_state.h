// The states of a component by name, as people and reports read them. Any thread.
#pragma once

#include <sinew_idl/status.h>

namespace sinew::wire {

// "unknown": a number without a name, of a damaged or foreign message.
constexpr const char* NameOf(msg::ComponentState state) noexcept {
  switch (state) {
    case msg::COMPONENT_CONFIGURED:
      return "configured";
    case msg::COMPONENT_ACTIVE:
      return "active";
    case msg::COMPONENT_FAULT:
      return "fault";
    case msg::COMPONENT_STOPPED:
      return "stopped";
  }
  return "unknown";
}

}  // namespace sinew::wire
