// Data faults planted into sound recordings: what the gate has to find. Deterministic by seed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"

namespace sinew::gate {

struct FaultKind {
  std::string name;
  std::vector<std::string> rules;  // any of them is right
  bool needs_hand = false;         // cannot show while nobody touches the load cell
};

const std::vector<FaultKind>& FaultKinds();

// Plants one fault. Throws std::invalid_argument for a name that FaultKinds does not have.
void Plant(const std::string& name, std::uint64_t seed, std::vector<types::Run>* runs,
           actuator::JointModel* model);

}  // namespace sinew::gate
