// Messages of what exists only in simulation, to and from the types of a simulated plant
// (simulated_plant.h): for state providers, and for programs that simulate behind one.
//
// Units and signs as in idl/simulation.idl. Any thread.
#pragma once

#include <sinew_idl/header.h>
#include <sinew_idl/simulation.h>

#include "components/robot/provider/simulated_plant.h"

namespace sinew::provider {

msg::SimTruth ToMessage(const msg::Header& header, int joint_count, const GearTruth& truth);
msg::SimBodyTruth ToMessage(const msg::Header& header, const BodyTruth& truth);
// As it came: IsPossible says whether it can act. Allocates.
BodyDisturbance FromMessage(const msg::SimBodyDisturbance& message);

}  // namespace sinew::provider
