// States of the kinematic balance: motor angle / N - output angle, where the teeth certainly touch.
//
// Which side they touch on follows from the torque that they carry, never from the difference
// itself. The model of motion gives that torque twice: what the rotor transmits, and what the link
// needs,
//
//     T_motor = sum over terms on the motor's side,   T_link = -(sum over terms on the output's
//     side),
//
// and their difference is the residual of the motion. Contact is sure where both have the same sign
// and are larger than kSureContact times the residual's rms for a while on either side: free teeth
// carry nothing, and an impact lets the two estimates part. Everything else is left out, rest and
// reversals too; but where the declared play is a small part of what the difference does
// (kSmallPlay of its middle four fifths), every moving row counts, and the play is noise. Teeth
// that only ever touch on one side show all but the play itself. The measured side is not filtered:
// an average over the play would be a side of its own. An encoder is set to zero anew when it
// starts, so only changes within a recording count: each is a window. Pure; allocates; throws
// std::invalid_argument as MakeStates.
#pragma once

#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/processing.h"

namespace sinew::identify {

inline constexpr double kSureContact = 4.0;
inline constexpr double kSmallPlay = 0.1;

// motion: options of the motion balance, resolved. fitted: the model fitted in it. residual_rms: of
// the torque balance before filtering; 0: taken from these recordings.
StateSet MakeKinematicStates(const std::vector<types::Run>& runs,
                             const actuator::JointModel& fitted, const ProcessingOptions& motion,
                             double residual_rms_Nm = 0.0);

// Rms of the torque balance at the moving samples, at the full rate.
double RawResidualTorque(const StateSet& states, const actuator::JointModel& fitted);

}  // namespace sinew::identify
