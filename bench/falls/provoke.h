// A scenario with robots/biped: the truth of whether it is a fall or a healthy squat, and what the
// guard makes of it.
#pragma once

#include <optional>
#include <string>

#include "bench/falls/run.h"
#include "bench/falls/scenarios.h"

namespace sinew::falls {

// After the first tick in which the truth says so a fall is to be found within this time.
inline constexpr double kRequired_s = 0.100;

struct ProvokeOptions {
  std::string root;                                            // folder of the project
  std::optional<provider::FallPolicy> on_fall = std::nullopt;  // instead of the world file's
  std::optional<double> damping_Nm_s_rad = std::nullopt;       // the same
  double after_s = 0.3;                                        // how long the joints are looked at
};

// The same run with nobody who looks for falls, whose truth says when it fell, and with the guard.
struct FallRun {
  Scenario scenario;
  RunResult unguarded, guarded;

  // Not before the disturbance, and at most kRequired_s after the truth.
  bool found() const;
  double latency_s() const;  // of the fault after the truth; negative: before it
};

struct SquatRun {
  Scenario scenario;
  RunResult guarded;

  bool alarm() const;  // also: the detector had not started when the squats began
};

// Nothing: by the truth it did not fall, or fell before anything happened to it. Throws as LoadRun
// and Run.
std::optional<FallRun> ProvokeFall(const Scenario& scenario, const ProvokeOptions& options);
// Nothing: by the truth these squats are not healthy.
std::optional<SquatRun> WatchSquats(const Scenario& scenario, const ProvokeOptions& options);

}  // namespace sinew::falls
