// The other balances beside the torque balance, and one result of all. Pure; allocates.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

// Balances beside the motion's that the model declares, in the order in which they are analysed.
std::vector<effects::Balance> OtherBalances(const actuator::JointModel& model);

// Analyses one of them with the model as the motion left it: its rows, its declared terms, its part
// of the catalogue. motion: options of the torque balance, resolved. When the recordings show
// nothing of it, the result has no effect and not_excited says why for every effect of that
// balance.
TraceResult TraceBalance(effects::Balance balance, const std::vector<types::Run>& train,
                         const std::vector<types::Run>& held_out,
                         const actuator::JointModel& corrected,
                         const identify::ProcessingOptions& motion, const TraceOptions& options);

// Adds what another balance found to the motion's result: effects, shifts and what could not be
// seen, the model's terms, and a summary with errors in that balance's unit. The motion's own
// errors stay.
TraceResult WithBalance(TraceResult motion, TraceResult other);

}  // namespace sinew::trace
