// The joint of a model on its own, as free_run::Compare moves it: the default where a recording
// does not involve other bodies.
#pragma once

#include "components/model/free_run/free_run.h"

namespace sinew::plant {

// The bodies that it makes are SingleJoints; they throw std::invalid_argument as SingleJoint does
// for a model that cannot be simulated.
free_run::MakeBody JointAlone();

}  // namespace sinew::plant
