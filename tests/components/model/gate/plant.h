// Data faults planted into sound recordings: what the gate has to find. Deterministic by seed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/gate/gate.h"

namespace sinew::gate {

struct FaultKind {
  std::string name;
  std::vector<std::string> rules;  // any of them is right
  bool needs_hand = false;         // cannot show while nobody touches the load cell
  bool leaves_out = false;         // nothing stops: its rows are left out
};

const std::vector<FaultKind>& FaultKinds();

// Did the gate find this fault by one of its rules, or leave its rows out?
bool IsFound(const FaultKind& kind, const GateReport& report);

// Plants one fault. Throws std::invalid_argument for a name that FaultKinds does not have.
void Plant(const std::string& name, std::uint64_t seed, std::vector<types::Run>* runs,
           actuator::JointModel* model);

}  // namespace sinew::gate
