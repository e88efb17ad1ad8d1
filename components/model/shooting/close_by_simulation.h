// The path of `sinew close-loop --by simulation`: where a torque balance cannot decide (free
// swings, stick-slip, a servo whose law is declared, sensors without a velocity) the declared terms
// are fitted by simulation, and the search for effects runs about that fit (shooting_problem.h) by
// the rules, the score and the report of the torque balance.
//
// What is selected is fitted again by simulation, with and without each member. On the held-out
// recordings start states and zeros alone are fitted; the slope is that of what is left there on
// the change of the simulated angle. Errors are of the angle of pieces that start from the measured
// state, rad (m): simulated less measured. Pure; allocates; reads no clock.
#pragma once

#include <vector>

#include "components/model/free_run/simulation.h"
#include "components/model/trace/close_loop.h"

namespace sinew::shooting {

// As trace::CloseLoop, without events and without balances beside the motion's. Recordings with
// fewer pieces than blocks are needed end as kTooLittleData. Throws std::invalid_argument for
// recordings that cannot be used and for a model that cannot be simulated.
trace::LoopResult CloseBySimulation(const std::vector<types::Run>& train,
                                    const std::vector<types::Run>& held_out,
                                    const actuator::JointModel& joint, double longest_gap_s,
                                    const trace::TraceOptions& options,
                                    const free_run::MakeBody& make_body);

}  // namespace sinew::shooting
