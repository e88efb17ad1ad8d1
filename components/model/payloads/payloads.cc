#include "components/model/payloads/payloads.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/bodies/links/fixed_links.h"

namespace sinew::arm {

Chain WithPayloads(Chain chain, const std::vector<actuator::Payload>& payloads) {
  for (const actuator::Payload& payload : payloads) {
    const Eigen::Vector3d at(payload.position_m[0], payload.position_m[1], payload.position_m[2]);
    if (!(payload.mass_kg > 0.0) || !std::isfinite(payload.mass_kg) || !at.allFinite()) {
      throw std::invalid_argument("payload of link '" + payload.link +
                                  "': " + std::to_string(payload.mass_kg) +
                                  " kg, expected above 0 at a finite position");
    }
    if (payload.link == chain.base.link_name) {
      AddPointMass(payload.mass_kg, at, &chain.base);
      continue;
    }
    const auto body = std::find_if(chain.bodies.begin(), chain.bodies.end(),
                                   [&](const Body& one) { return one.link_name == payload.link; });
    if (body == chain.bodies.end()) {
      throw std::invalid_argument("payload of link '" + payload.link + "': robot '" + chain.name +
                                  "' has no such link");
    }
    AddPointMass(payload.mass_kg, at, &*body);
  }
  return chain;
}

}  // namespace sinew::arm
