// A second look at the recordings where they creep.
//
// Torque that repeats with the motor's angle (cogging) is fast at most speeds: filters take it
// away, or it moves the rotor instead of showing in the drive. Where the joint creeps it is slow.
// So the effects that follow the motor's angle are asked for once more, beside the model that the
// first look gave, on the designs that identify::SlowMotion describes. Pure; allocates.
#pragma once

#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/design.h"
#include "components/trace/tracer.h"

namespace sinew::trace {

// Effects of the catalogue whose residual follows the motor's angle.
std::vector<std::string> EffectsOfMotorAngle(const actuator::JointModel& model);

// The model with all its parameters held but those that creeping shows: dry friction, gravity, an
// offset.
actuator::JointModel HeldForSlowMotion(const actuator::JointModel& model);

// Is there enough slow motion, and is the motor's angle recorded?
bool ShowsSlowMotion(const identify::Design& train, const identify::Design& sealed);

// Adds what the second look found to the first's result. Nothing found: the first, unchanged. When
// the first look had found no effect, errors, floor and ceiling are those of the second, because
// only there the effect shows: `slow_motion` of the result says so. Slow rounds come behind the
// first's.
TraceResult WithSlowMotion(TraceResult first, TraceResult slow);

}  // namespace sinew::trace
