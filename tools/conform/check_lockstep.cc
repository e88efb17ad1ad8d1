// Lockstep: nothing is lost, and two runs are equal to the bit.
#include <algorithm>
#include <csignal>
#include <map>
#include <optional>
#include <vector>

#include "components/topics/node/topics.h"
#include "tools/conform/real_time_run.h"

namespace sinew::conform {

namespace {

using std::chrono::milliseconds;

constexpr int kRunTicks = 200;
constexpr int kArmedAt = 20;
constexpr milliseconds kRest(500);  // for outputs of the last ticks that nothing waited for

struct LockstepRun {
  bool started = false;
  Window window;
  int exit_code = launch::Program::kTimeout;
};

void Append(Window* all, Window&& part) {
  all->ticks += part.ticks;
  for (auto& [topic, outputs] : part.outputs) {
    auto& to = all->outputs[topic];
    std::move(outputs.begin(), outputs.end(), std::back_inserter(to));
  }
}

// Ends by the last tick, or by the signal while the program waits for one.
LockstepRun RunOnce(const Options& options, const Role& role, std::optional<int> signal) {
  LockstepRun run;
  const std::string name = "conform_subject";
  Stage stage(role, {.domain_id = options.domain_id,
                     .mode = node::TimeMode::kLockstep,
                     .rate_Hz = options.rate_Hz,
                     .subject = name});
  launch::Program program(SubjectCommandLine(options, name, node::TimeMode::kLockstep));
  run.started = stage.WaitUntil(
      [&] {
        for (const node::TopicInfo& topic : role.must_write) {
          if (!stage.IsHeard(topic.name)) return false;
        }
        return stage.SubjectReads(node::kJointState.name) && stage.status().has_value();
      },
      kStart);
  if (run.started) {
    run.window.session_id = stage.session_id();
    const Moment disarmed{.joints = options.joints};
    Moment moment = disarmed;
    Append(&run.window, stage.Play(moment, kArmedAt));
    moment.robot_state = msg::RobotState::kArmed;
    Append(&run.window, stage.Play(moment, kRunTicks - kArmedAt - 1));
    moment.last_tick = !signal;
    Append(&run.window, stage.Play(moment, 1));
  }
  if (signal) program.Signal(*signal);
  run.exit_code = program.Wait(kEnd);
  return run;
}

// The difference of two runs; empty: none. The last tick of the first one ends its session.
std::string Difference(const Role& role, const LockstepRun& one, const LockstepRun& other) {
  std::vector<node::TopicInfo> topics = role.must_write;
  topics.insert(topics.end(), role.may_write.begin(), role.may_write.end());
  for (const node::TopicInfo& topic : topics) {
    const auto first = one.window.Of(topic.name), second = other.window.Of(topic.name);
    const bool must = role.must_write.end() !=
                      std::find_if(role.must_write.begin(), role.must_write.end(),
                                   [&](const node::TopicInfo& t) { return t.name == topic.name; });
    if (must && first.size() != second.size()) {
      return topic.name + ": " + std::to_string(first.size()) + " and " +
             std::to_string(second.size()) + " outputs";
    }
    // By tick, of which a topic may have several outputs (parts of a snapshot). The first outputs
    // of a topic that the role may write, whose reader nobody waited for, may be lost.
    std::map<std::uint64_t, std::vector<const Output*>> of_tick;
    std::map<std::uint64_t, std::size_t> first_count;
    for (const Output* output : second) {
      if (output->facts) of_tick[output->facts->tick].push_back(output);
    }
    for (const Output* output : first) {
      if (output->facts) ++first_count[output->facts->tick];
    }
    for (std::size_t i = 0; i + 1 < first.size(); ++i) {
      if (!first[i]->facts) continue;
      const std::uint64_t tick = first[i]->facts->tick;
      const std::vector<const Output*>& same = of_tick[tick];
      if (!must && same.size() < first_count[tick]) continue;
      const bool repeated = std::any_of(same.begin(), same.end(), [&](const Output* output) {
        return output->facts->canonical == first[i]->facts->canonical;
      });
      if (!repeated) {
        return topic.name + " differs at tick " + std::to_string(first[i]->facts->tick);
      }
    }
  }
  return "";
}

}  // namespace

void CheckLockstep(const Options& options, const Role& role, Report* report) {
  constexpr const char* kChecks[] = {"lockstep_every_tick", "lockstep_repeats", "end_of_session",
                                     "sigint"};
  if (!options.lockstep) {
    for (const char* check : kChecks) report->Skip(check, "the program knows real time only");
    return;
  }
  const LockstepRun one = RunOnce(options, role, std::nullopt);
  const LockstepRun other = RunOnce(options, role, SIGINT);
  int answered = kRunTicks;
  for (const node::TopicInfo& topic : role.must_write) {
    answered = std::min(answered, one.window.Answered(topic.name));
  }
  report->Add("lockstep_every_tick", one.started && answered == kRunTicks,
              "every tick answered in order, with --lockstep",
              one.started ? std::to_string(answered) + " of " + std::to_string(kRunTicks) + " ticks"
                          : "did not start");
  const std::string difference = Difference(role, one, other);
  const bool both = one.started && other.started && answered > 0;
  report->Add("lockstep_repeats", both && difference.empty(), "two runs are equal to the bit",
              !both                ? "did not run"
              : difference.empty() ? std::to_string(answered) + " ticks equal"
                                   : difference);
  report->Add("end_of_session", one.exit_code == 0,
              "exit code 0 within " + std::to_string(kEnd.count()) + " ms of the last tick",
              EndText(one.exit_code));
  report->Add("sigint", other.exit_code == 0,
              "exit code 0 within " + std::to_string(kEnd.count()) +
                  " ms of SIGINT, while it waits for a tick",
              EndText(other.exit_code));
}

}  // namespace sinew::conform
