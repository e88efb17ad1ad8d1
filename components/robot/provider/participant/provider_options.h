// Options and configuration of a state provider's loop.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/provider/guard.h"
#include "components/robot/provider/plant.h"
#include "components/robot/provider/work_time.h"

namespace CLI {
class App;
}

namespace sinew::provider {

// Other participants in the state provider's thread (components/topics/node/composition.h). Real
// time only.
class ComposedCycle {
 public:
  virtual ~ComposedCycle() = default;
  // The state of a tick is published: they answer it.
  virtual void Answer() = 0;
  // The plant has its command: the rest may take its time.
  virtual void Finish() = 0;
};

struct ProviderOptions {
  double rate_Hz = 240.0;
  double duration_s = 0.0;  // 0: until stopped
  // Armed from tick 0, in real time once a joint command answers; refused for live plants.
  bool arm = false;
  // Lockstep: "joint_command", "recording_progress:128" (window in ticks).
  std::vector<std::string> await;
  // Lockstep: a reply that takes longer ends the session with an error. Real time: arm is given up.
  double await_timeout_s = 30.0;
  ComposedCycle* composed = nullptr;  // what runs in this thread between state and command
  // Real time, armed: from the write of joint_state to its command, decoded.
  WorkTime* answers = nullptr;
  // Work of real-time cycles, without their waits; null: measured all the same.
  WorkTime* work = nullptr;
  // Called in the loop with what the plant's sensors read and when, s since the start: after Reset
  // with 0, and after each Step. Must not wait in real time.
  std::function<void(double time_s, const PlantSensors& sensors)> stepped;
};

// Adds --rate, --duration, --arm, --await, --await-timeout to a participant.
void AddProviderOptions(CLI::App& app, ProviderOptions* options);

// A `guard:` block. The caller rejects its unknown keys. Throws UsageError, one line with file and
// key.
void Describe(config::Fields& fields, GuardConfig& config);
GuardConfig LoadGuardConfig(const config::Section& guard);

}  // namespace sinew::provider
