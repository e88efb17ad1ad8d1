// A joint model integrated beside a recording, to compare simulated with measured motion.
//
// Two ways, chosen by what is known of the recording (docs/model.md):
//
// - closed loop: where the model declares the servo (actuator::Servo) and the recording holds the
//   set point, the servo moves the model along the set point from the recording's first state on.
// - horizons: else the recorded drive moves the model for `horizon_s`, again and again from the
//   recorded state. A loaded joint driven by effort for longer
//   diverges with any model, which proves nothing.
//
// What moves comes from the caller (simulation.h), e.g. plant::JointAlone: friction as an impulse,
// so that a joint that sticks stands exactly still. Terms with memory are advanced along the
// recording up to each start. Pressure, load force, payload and temperature are the recorded ones.
// Errors are simulated minus measured (state-filtered) position, in rad, in m for a linear joint.
// Pure; allocates; one thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/free_run/simulation.h"
#include "components/model/identify/processing.h"

namespace sinew::free_run {

struct FreeRunOptions {
  double horizon_s = 0.5;
  double step_s = 2.0e-4;  // halved for joints with free play
};

enum class Method { kClosedLoop, kHorizons };

// One model along one recording.
struct RunError {
  std::string run;
  double mean_abs = 0.0;  // rad or m, over all samples that did not diverge
  double rms = 0.0;
  double samples = 0.0;     // that counted
  int pieces = 0;           // pieces of the recording (closed loop) or horizons
  int diverged = 0;         // of them: left the range of the recorded motion by more than its width
  double servo_gain = 0.0;  // closed loop: as declared, or as read from the recording
};

// One model along all recordings.
struct ModelError {
  std::vector<RunError> runs;
  // Over all recordings, samples weighted equally. NaN: it diverged in more than half of its pieces
  // and is compared with nothing.
  double mean_abs = 0.0, rms = 0.0;
  int pieces = 0, diverged = 0;
};

struct FreeRun {
  Method method = Method::kHorizons;
  double horizon_s = 0.0;          // horizons only
  std::vector<ModelError> models;  // in the order given
};

// Simulated positions at the samples of one piece of a recording, NaN where a model diverged; for
// plots.
struct Trace {
  int run = 0;
  double start_s = 0.0, period_s = 0.0;
  std::vector<double> measured;                // rad or m
  std::vector<std::vector<double>> simulated;  // by model
};

struct FreeRunResult {
  std::optional<FreeRun> errors;  // empty: see why
  std::string why_not;            // one sentence, e.g. a model without inertia
  std::vector<Trace> traces;      // closed loop: whole pieces; horizons: one after the other
};

// models: of the same joint, at least one; the last one declares the servo. Errors are over the
// samples that every model reached, those that diverged in more than half of their pieces apart.
// options of processing must be resolved. Throws std::invalid_argument as identify::MakeStates for
// recordings that cannot be used.
FreeRunResult Compare(const std::vector<types::Run>& runs,
                      const std::vector<actuator::JointModel>& models,
                      const identify::ProcessingOptions& processing, const MakeBody& make_body,
                      const FreeRunOptions& options = {});

// Results of the same models on different recordings, as one; a part without errors gives its
// reason. Errors are weighted by the samples that counted.
FreeRunResult Join(std::vector<FreeRunResult> parts);

}  // namespace sinew::free_run
