// The loop of a state provider (world, surrogate, can_bridge) around its Plant: timer or lockstep,
// topics in and out. What it decides is in provider_cycle.h.
//
// Tick k: joint_state(k) and actuator_state(k) go out; commands that answer tick k are applied from
// k to k + 1. Real time: absolute CLOCK_MONOTONIC deadlines, overruns counted. Lockstep: tick k
// ends when every topic of `await` has answered it (or is at most its window behind), however long
// that takes.
//
// An estop of the socket ends every wait of a real-time cycle: a plant that acts at once is idled
// before anything else is done.
#pragma once

#include "components/robot/estop/estop_config.h"
#include "components/robot/provider/guard.h"
#include "components/robot/provider/participant/provider_options.h"
#include "components/robot/provider/plant.h"
#include "components/topics/node/options.h"

namespace sinew::provider {

// Returns when the session ended or stop was requested. guard.live is taken from the plant.
// `estop`: the socket that takes an estop without DDS and the latch that outlives the process; with
// neither, an estop comes by DDS and ends with the process. Throws UsageError (bad options, a
// second state provider in the domain or at the socket), std::runtime_error (a reply never came).
void RunProvider(const node::Options& node_options, node::StopFlag& stop,
                 const ProviderOptions& options, const GuardConfig& guard, Plant& plant,
                 const estop::Config& estop = {});

}  // namespace sinew::provider
