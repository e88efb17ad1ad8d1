// A stand-in publishes component_status as the component whose place it takes: two of one kind
// stand in for each other.
#pragma once

#include <string>

#include "components/topics/node/options.h"

namespace sinew::stand_ins {

// The options of a program that stands in for a component, e.g. "pneumatics".
inline node::Options StandsInFor(const std::string& component, node::Options options) {
  options.component = component;
  return options;
}

}  // namespace sinew::stand_ins
