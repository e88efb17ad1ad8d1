// A simulated plant: what acts on the links from outside is set by the simulation's user.
//
// Only simulations implement this interface; a plant of hardware has no disturbances to set. A
// state provider reads sim_disturbance only for a plant of this kind.
#pragma once

#include "components/provider/plant.h"
#include "components/types/joints.h"

namespace sinew::provider {

// What acts on each joint's link from outside.
struct Disturbance {
  types::JointArray<double> hand_force_N{};      // at the load cell, positive presses down
  types::JointArray<double> extra_payload_kg{};  // in addition to the declared payload
};

class SimulatedPlant : public Plant {
 public:
  // Acts from the next Step on, until the next call; Reset ends it. Does not allocate. Values that
  // are not finite: as the plant's own header says.
  virtual void Disturb(const Disturbance& disturbance) = 0;
};

}  // namespace sinew::provider
