// A joint for the tests of the parts: node 3, 100:1, with a sensor node.
#pragma once

#include <cstdint>

#include "bridge/joints/joint_config.h"

namespace sinew::bridge {

inline constexpr std::int64_t kMs_ns = 1'000'000;

inline JointConfig Knee() {
  JointConfig joint;
  joint.name = "knee";
  joint.node = 3;
  joint.gear_ratio = 100.0;
  joint.limits = {0.4, 25.0, 2.0, -1.0, 1.5, 0.2, 90.0};
  joint.output = OutputNode{35, 1, 0.0};
  return joint;
}

}  // namespace sinew::bridge
