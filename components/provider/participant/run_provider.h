// The loop of a state provider (world, surrogate, can_bridge) around its Plant: timer or lockstep,
// arming, command guard, publishing joint_state, actuator_state and what else the plant has.
//
// Tick k: joint_state(k) and actuator_state(k) go out; commands that answer tick k are applied from
// k to k + 1. Real time: absolute CLOCK_MONOTONIC deadlines, overruns counted. Lockstep: tick k
// ends when every topic of `await` has answered it (or is at most its window behind), however long
// that takes.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "components/config/config.h"
#include "components/node/options.h"
#include "components/provider/guard.h"
#include "components/provider/plant.h"

namespace CLI {
class App;
}

namespace sinew::provider {

struct ProviderOptions {
  double rate_Hz = 240.0;
  double duration_s = 0.0;  // 0: until stopped
  bool arm = false;         // armed from tick 0; refused for live plants
  std::vector<std::string>
      await;  // lockstep: "joint_command", "recording_progress:128" (window in ticks)
  double await_timeout_s = 30.0;  // a reply that takes longer ends the session with an error
};

// Adds --rate, --duration, --arm, --await, --await-timeout to a participant.
void AddProviderOptions(CLI::App& app, ProviderOptions* options);

// Keys of a `guard:` block: missed_periods, fault_after_ms, bridging (damp|hold), damping_Nm_s_rad.
GuardConfig LoadGuardConfig(const config::Section& guard);

// Returns when the session ended or stop was requested. Throws UsageError (bad options, a second
// state provider in the domain), std::runtime_error (a reply never came).
void RunProvider(const node::Options& node_options, node::StopFlag& stop,
                 const ProviderOptions& options, const GuardConfig& guard, Plant& plant);

}  // namespace sinew::provider
