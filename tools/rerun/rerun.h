// Components run again on the inputs of a recording, and compared with what they wrote then.
//
// Each component runs alone and gets what the recording has, so that a difference is its own and
// not one of those before it. Lockstep: in every tick the samples of that tick. Real time: the
// samples that its recorded outputs name by their ticks (idl/header.idl), in the ticks for which it
// has outputs. Operator's commands and requests are fed in the tick whose outputs name them.
//
// Thread: the caller's; needs no DDS and no clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/options.h"
#include "tools/compose/chain.h"
#include "tools/rerun/differences.h"
#include "tools/rerun/message_diff.h"
#include "tools/rerun/recorded_ticks.h"

namespace sinew::rerun {

enum class Verdict {
  kIdentical,
  kDiffers,     // `difference`
  kInputLost,   // `lost`: a sample that was used is not in the recording
  kOutputLost,  // `lost`: of a cycle whose outputs the recording lacks, and so its inputs; or it
                // was started again
  kNothing,     // the recording has no output of it
};

struct Difference {
  std::string topic;
  std::uint64_t tick = 0;
  FieldDifference field;
};

struct ComponentResult {
  std::string name;
  Verdict verdict = Verdict::kNothing;
  std::optional<std::uint64_t> from_tick;  // of the snapshot; none: from the start
  std::uint64_t ticks = 0;                 // cycles that were run again
  std::uint64_t messages = 0;              // compared
  std::optional<Difference> difference;
  std::string lost;                       // one line: topic, tick, who names it
  std::uint64_t lost_tick = 0;            // of the cycle
  std::vector<FieldSummary> differences;  // of all messages, where they are asked for
};

// A field over time, as recorded and as it is now; s since the session's tick 0.
struct FieldCurve {
  std::string topic, field;
  std::vector<double> time_s, recorded, rerun;
};

struct RerunResult {
  Session session;
  bool lockstep = false;
  std::vector<ComponentResult> components;
  std::optional<FieldCurve> curve;  // where it is asked for
  double wall_s = 0.0;

  bool identical() const;
  double recorded_s() const;  // that were run again, by the ticks
};

struct RerunInput {
  std::string file;  // in messages
  Session session;
  node::TimeMode mode = node::TimeMode::kLockstep;
  std::vector<compose::Part> parts;
  // Each component goes on from its last snapshot up to here; none: from the start.
  std::optional<double> from_s{};
  // Goes on after the first difference, with the recorded inputs, and sums all up.
  bool all_differences = false;
  // A number in an output of a component, collected over all ticks.
  struct Field {
    std::string topic, field;
  };
  std::optional<Field> curve{};
};

// `progress` receives the ticks done and those of the session, if given. Throws UsageError for a
// configuration, a session that does not begin with tick 0 or has no snapshot up to from_s, a topic
// that a component reads and the recording has not, one with several writers, or types of another
// build; recording::McapError.
RerunResult Rerun(const recording::McapReader& reader, const RerunInput& input,
                  node::StopFlag& stop,
                  const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace sinew::rerun
