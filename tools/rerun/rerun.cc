#include "tools/rerun/rerun.h"

#include <sinew_idl/snapshot.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "components/base/config/config.h"
#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/tick_loop.h"
#include "components/topics/node/topics.h"
#include "tools/rerun/output_facts.h"
#include "tools/rerun/recorded_ticks.h"
#include "tools/rerun/stage.h"

namespace sinew::rerun {
namespace {

// The snapshots of a recording (topic component_snapshot), put together from their parts.
struct Snapshot {
  std::uint64_t tick = 0;  // after this cycle
  std::uint32_t version = 0;
  node::Bytes content;
};

// A snapshot whose parts come one after the other.
struct Gathered {
  Snapshot snapshot;
  std::uint32_t next_part = 0;
};

// The last whole snapshot of each participant, by name, of the session up to `last_tick`. One that
// lacks a part counts as none. `file` is named in messages. Throws UsageError when they are of
// another type than this build's; recording::McapError.
std::map<std::string, Snapshot> SnapshotsUpTo(const recording::McapReader& reader,
                                              const std::string& file, const Session& session,
                                              std::uint64_t last_tick) {
  CheckTypes(reader, file, {"component_snapshot"});
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>{"component_snapshot"};
  filter.in_file_order = session.in_file_order;
  recording::McapMessages messages = reader.Messages(filter);
  std::map<std::string, Snapshot> whole;
  std::map<std::string, Gathered> gathered;
  recording::McapMessage message;
  while (messages.Next(&message)) {
    msg::ComponentSnapshot part;
    if (!node::Decode({message.data.begin(), message.data.end()}, &part)) continue;
    if (part.header.session_id != session.id || part.header.tick > last_tick) continue;
    const std::string name = part.name;
    Gathered& now = gathered[name];
    if (part.part == 0) now = {{part.header.tick, part.version, {}}, 0};
    if (part.part != now.next_part || part.header.tick != now.snapshot.tick) continue;
    const auto* begin = reinterpret_cast<const std::byte*>(part.content.data());
    now.snapshot.content.insert(now.snapshot.content.end(), begin, begin + part.content.size());
    if (++now.next_part == part.part_count) whole[name] = std::move(now.snapshot);
  }
  return whole;
}

bool IsEvent(std::string_view topic) {
  return node::FindTopic(topic)->profile == node::Profile::kEvent;
}

// Requests of motion are states of a requester, sent in every tick or when it changes its mind:
// outputs name them by their tick.
bool IsNamedByTick(std::string_view topic) { return !IsEvent(topic) || topic == "motion_request"; }

std::string At(std::string_view topic, std::uint64_t tick) {
  return std::string(topic) + " of tick " + std::to_string(tick);
}

// A component that is run again, and what is known of it so far.
class Run {
 public:
  // snapshot: where it goes on; none: from the start.
  Run(const compose::Part& part, node::TimeMode mode, std::optional<Snapshot> snapshot,
      bool all_differences, node::StopFlag& stop)
      : snapshot_(std::move(snapshot)),
        all_differences_(all_differences),
        lockstep_(mode == node::TimeMode::kLockstep),
        stage_(part, mode, stop) {
    result_.name = part.name;
    if (snapshot_) result_.from_tick = snapshot_->tick;
    for (const std::string& topic : stage_.outputs()) facts_.emplace_back(topic);
  }

  // Collects this field of an output.
  void Collect(FieldCurve* curve, double period_s) {
    curve_ = curve;
    period_s_ = period_s;
    curve_field_.emplace(TypeOf(curve->topic), curve->field);
    if (!curve_field_->type().is_number()) {
      throw recording::CdrError("field '" + curve->field + "' is a text, expected a number");
    }
  }

  const Stage& stage() const { return stage_; }
  ComponentResult result() const {
    ComponentResult result = result_;
    result.differences = differences_.Summaries();
    return result;
  }
  bool over() const { return over_; }

  void Cycle(const RecordedTicks& recorded, std::uint64_t tick) {
    if (snapshot_ && tick < snapshot_->tick) return;
    if (snapshot_ && tick > snapshot_->tick) {
      return Lose(tick, At("joint_state", snapshot_->tick) +
                            " is not in the recording, from which its snapshot goes on");
    }
    const UsedInputs used = UsedIn(recorded, tick);
    const bool at_snapshot = snapshot_ && snapshot_->tick == tick;
    if (!lockstep_ && !at_snapshot) {
      if (!used.any_output) return;  // it had no cycle, or the next output names it
      if (used.previous_cycle) CheckCycles(*used.previous_cycle, tick);
      if (over_) return;
    }
    last_cycle_ = tick;
    stage_.SetJoining(used.joining);
    FeedInputs(recorded, tick, used);
    if (!snapshot_) FeedEvents(recorded, tick, used);
    if (over_) return;
    for (const node::Bytes& state : *recorded.Find("joint_state", tick)) {
      stage_.Feed("joint_state", state);
    }
    if (snapshot_) return Resume();
    if (!stage_.Step()) return;
    ++result_.ticks;
    for (const std::string& topic : stage_.outputs()) Compare(recorded, topic, tick);
  }

 private:
  // Its cycle before this one must be the last that was run again.
  void CheckCycles(std::uint64_t previous, std::uint64_t tick) {
    if (previous == last_cycle_.value_or(node::kNoTick)) return;
    const std::string in_tick = " in tick " + std::to_string(tick);
    if (previous == node::kNoTick) {
      End(Verdict::kOutputLost, tick, stage_.name() + " was started again" + in_tick);
    } else {
      End(Verdict::kOutputLost, tick,
          "the outputs of its cycle in tick " + std::to_string(previous) + ", which it names" +
              in_tick + ", are not in the recording");
    }
  }

  // The inputs that were fed are those of the snapshot's cycle.
  void Resume() {
    try {
      stage_.Resume({snapshot_->version, snapshot_->content});
    } catch (const std::invalid_argument& error) {
      throw UsageError("'" + stage_.name() + "': the snapshot of tick " +
                       std::to_string(snapshot_->tick) +
                       " does not fit its configuration: " + error.what());
    }
    snapshot_.reset();
  }

  // The inputs that its recorded outputs of this tick name.
  UsedInputs UsedIn(const RecordedTicks& recorded, std::uint64_t tick) const {
    UsedInputs used;
    for (const OutputFacts& facts : facts_) {
      const auto* sent = recorded.Find(facts.topic(), tick);
      if (sent != nullptr) facts.AddTo(sent->back(), &used);
    }
    return used;
  }

  void FeedInputs(const RecordedTicks& recorded, std::uint64_t tick, const UsedInputs& used) {
    for (const std::string& topic : stage_.inputs()) {
      if (topic == "joint_state" || !IsNamedByTick(topic)) continue;
      const auto named = used.tick.find(topic);
      const bool by_name = named != used.tick.end() && (!lockstep_ || IsEvent(topic));
      if (by_name && named->second == node::kNoTick) continue;
      const std::uint64_t wanted = by_name ? named->second : tick;
      const auto* samples = recorded.Find(topic, wanted);
      if (samples != nullptr && !(fed_.contains(topic) && fed_[topic] >= wanted)) {
        fed_[topic] = wanted;
        for (const node::Bytes& sample : *samples) stage_.Feed(topic, sample);
      }
      if (named == used.tick.end() || named->second == node::kNoTick) continue;
      // In lockstep an input is of this tick or of the one before; other numbers are a damaged
      // output, which the comparison finds.
      const bool plausible =
          !lockstep_ || IsEvent(topic) || named->second == tick || named->second + 1 == tick;
      const bool was_fed = fed_.contains(topic) && fed_[topic] == named->second;
      if (plausible && !was_fed && recorded.Find(topic, named->second) == nullptr) {
        Lose(tick, At(topic, named->second) + " is not in the recording; " + stage_.name() +
                       " used it in tick " + std::to_string(tick));
        return;
      }
    }
  }

  void FeedEvents(const RecordedTicks& recorded, std::uint64_t tick, const UsedInputs& used) {
    for (const std::uint64_t id : used.events) {
      bool found = false;
      for (const std::string& topic : stage_.inputs()) {
        if (!IsEvent(topic)) continue;
        const node::Bytes* event = recorded.FindEvent(topic, id);
        if (event == nullptr) continue;
        stage_.Feed(topic, *event);
        found = true;
      }
      if (found || over_) continue;
      Lose(tick, "the event " + std::to_string(id) + " is not in the recording; " + stage_.name() +
                     " used it in tick " + std::to_string(tick));
    }
  }

  void Compare(const RecordedTicks& recorded, const std::string& topic, std::uint64_t tick) {
    if (over_) return;
    const auto* then = recorded.Find(topic, tick);
    const node::Bytes* now = stage_.Output(topic);
    if (then == nullptr && now == nullptr) return;
    if (then == nullptr) {
      const bool gap = recorded.HasLater(topic, tick);
      if (lockstep_ && gap) {
        End(Verdict::kOutputLost, tick, At(topic, tick) + " is not in the recording");
      }
      return;
    }
    if (curve_ != nullptr && curve_->topic == topic && now != nullptr) {
      curve_->time_s.push_back(static_cast<double>(tick) * period_s_);
      curve_->recorded.push_back(curve_field_->AsDouble(then->back()));
      curve_->rerun.push_back(curve_field_->AsDouble(*now));
    }
    ++result_.messages;
    if (result_.verdict == Verdict::kNothing) result_.verdict = Verdict::kIdentical;
    const node::Bytes nothing;
    const auto field =
        FirstDifference(TypeOf(topic), then->back(), now != nullptr ? *now : nothing);
    if (!field) return;
    if (!result_.difference) result_.difference = Difference{topic, tick, *field};
    result_.verdict = Verdict::kDiffers;
    over_ = !all_differences_;
    if (all_differences_ && now != nullptr) {
      differences_.Add(topic, tick, TypeOf(topic), then->back(), *now);
    }
  }

  void Lose(std::uint64_t tick, const std::string& what) { End(Verdict::kInputLost, tick, what); }
  void End(Verdict verdict, std::uint64_t tick, const std::string& lost) {
    result_.verdict = verdict;
    result_.lost = lost;
    result_.lost_tick = tick;
    over_ = true;
  }

  std::optional<Snapshot> snapshot_;         // until it is reached
  std::optional<std::uint64_t> last_cycle_;  // that was run again, or of the snapshot
  const bool all_differences_;
  const bool lockstep_;
  Stage stage_;
  std::vector<OutputFacts> facts_;
  std::map<std::string, std::uint64_t> fed_;  // the last tick of each input
  ComponentResult result_;
  Differences differences_;
  FieldCurve* curve_ = nullptr;
  std::optional<recording::CdrField> curve_field_;
  double period_s_ = 0.0;
  bool over_ = false;
};

// The recording must have what the components read; events need not have happened.
void CheckInputs(const RecordedTicks& recorded, const std::string& file,
                 const std::vector<std::unique_ptr<Run>>& runs) {
  for (const auto& run : runs) {
    for (const std::string& topic : run->stage().inputs()) {
      if (IsEvent(topic) || recorded.Has(topic)) continue;
      throw UsageError(file + ": no topic '" + topic + "', which '" + run->stage().name() +
                       "' reads with this configuration");
    }
  }
}

// By component. Empty: everything goes from the start.
std::map<std::string, Snapshot> SnapshotsFor(const recording::McapReader& reader,
                                             const RerunInput& input) {
  if (!input.from_s) {
    if (input.session.first_tick == 0) return {};
    throw UsageError(input.file + ": its session begins with tick " +
                     std::to_string(input.session.first_tick) +
                     ", expected one from tick 0, or --from with a snapshot in the recording");
  }
  const auto last_tick = static_cast<std::uint64_t>(*input.from_s / input.session.period_s);
  std::map<std::string, Snapshot> snapshots =
      SnapshotsUpTo(reader, input.file, input.session, last_tick);
  for (const compose::Part& part : input.parts) {
    if (snapshots.contains(part.name)) continue;
    throw UsageError(input.file + ": no snapshot of '" + part.name + "' up to tick " +
                     std::to_string(last_tick) + " (" + std::to_string(*input.from_s) +
                     " s); `sinew snapshot` asks for one while the recorder runs");
  }
  return snapshots;
}

// The component that writes the topic collects it.
void CollectCurve(const RerunInput& input, const std::vector<std::unique_ptr<Run>>& runs,
                  FieldCurve* curve) {
  *curve = {input.curve->topic, input.curve->field, {}, {}, {}};
  for (const auto& run : runs) {
    const std::vector<std::string>& outputs = run->stage().outputs();
    if (std::find(outputs.begin(), outputs.end(), curve->topic) == outputs.end()) continue;
    try {
      run->Collect(curve, input.session.period_s);
    } catch (const recording::CdrError& error) {
      throw UsageError("topic '" + curve->topic + "': " + error.what());
    }
    return;
  }
  throw UsageError("topic '" + curve->topic + "': no component that is run again writes it");
}

}  // namespace

bool RerunResult::identical() const {
  return std::all_of(components.begin(), components.end(), [](const ComponentResult& component) {
    return component.verdict == Verdict::kIdentical;
  });
}

double RerunResult::recorded_s() const {
  std::uint64_t ticks = 0;
  for (const ComponentResult& component : components) ticks = std::max(ticks, component.ticks);
  return static_cast<double>(ticks) * session.period_s;
}

RerunResult Rerun(const recording::McapReader& reader, const RerunInput& input,
                  node::StopFlag& stop,
                  const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::unique_ptr<Run>> runs;
  std::set<std::string> topics;
  const std::map<std::string, Snapshot> snapshots = SnapshotsFor(reader, input);
  for (const compose::Part& part : input.parts) {
    std::optional<Snapshot> snapshot;
    if (input.from_s) snapshot = snapshots.at(part.name);
    runs.push_back(
        std::make_unique<Run>(part, input.mode, std::move(snapshot), input.all_differences, stop));
    const Stage& stage = runs.back()->stage();
    topics.insert(stage.inputs().begin(), stage.inputs().end());
    topics.insert(stage.outputs().begin(), stage.outputs().end());
  }
  RerunResult result;
  if (input.curve) CollectCurve(input, runs, &result.curve.emplace());
  const std::vector<std::string> read(topics.begin(), topics.end());
  CheckTypes(reader, input.file, read);
  CheckWriters(reader, input.file, read);
  RecordedTicks recorded(reader, input.session, read);
  CheckInputs(recorded, input.file, runs);
  while (const auto tick = recorded.Next()) {
    if (stop.requested()) break;
    bool all_over = true;
    for (const auto& run : runs) {
      if (!run->over()) run->Cycle(recorded, *tick);
      all_over = all_over && run->over();
    }
    if (all_over) break;
    if (progress) progress(*tick + 1, input.session.last_tick + 1);
  }
  result.session = input.session;
  result.lockstep = input.mode == node::TimeMode::kLockstep;
  for (const auto& run : runs) result.components.push_back(run->result());
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace sinew::rerun
