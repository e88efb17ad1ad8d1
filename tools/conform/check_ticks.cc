// One output a tick, of that tick, within its cycle.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "components/base/types/joined.h"
#include "components/base/types/median.h"
#include "tools/conform/real_time_run.h"

namespace sinew::conform {

namespace {

// The first fault of the ticks of a topic's outputs; empty: none.
std::string TickFault(const Window& window, const std::string& topic) {
  const auto outputs = window.outputs.find(topic);
  if (outputs == window.outputs.end()) return "";
  std::uint64_t last = 0;
  bool any = false;
  for (const Output& output : outputs->second) {
    if (!output.facts) return topic + ": " + std::to_string(output.size) + " bytes are no message";
    const Facts& facts = *output.facts;
    if (facts.session_id != window.session_id) {
      return topic + ": session " + std::to_string(facts.session_id) + " instead of " +
             std::to_string(window.session_id);
    }
    if (output.early) {
      return topic + ": tick " + std::to_string(facts.tick) + ", before its joint_state";
    }
    if (any && facts.tick <= last) {
      return topic + ": tick " + std::to_string(facts.tick) + " after " + std::to_string(last);
    }
    last = facts.tick;
    any = true;
  }
  return "";
}

}  // namespace

std::string EndText(int exit_code, std::chrono::milliseconds limit) {
  if (exit_code == launch::Program::kTimeout) {
    return "still runs after " + std::to_string(limit.count()) + " ms";
  }
  if (exit_code < 0) return "ended by signal " + std::to_string(-exit_code);
  return "exit code " + std::to_string(exit_code);
}

std::string LastLine(const launch::Program& program) {
  std::istringstream lines(program.output() + program.error());
  std::string last;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

std::string Percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

double ShareOf(const std::vector<const Output*>& outputs, bool (*condition)(const Facts&)) {
  if (outputs.empty()) return 0.0;
  const auto count = std::count_if(outputs.begin(), outputs.end(),
                                   [condition](const Output* o) { return condition(*o->facts); });
  return static_cast<double>(count) / static_cast<double>(outputs.size());
}

Window PlayWindows(RealTimeRun& run, const Moment& like,
                   const std::function<bool(const Window&)>& is_good) {
  Window window;
  bool good = false;
  for (const WindowRule& rule : kWindows) {
    run.stage.SetRate(rule.share_of_rate * run.options.rate_Hz);
    for (int i = 0; i < rule.windows && !good; ++i) {
      window = run.stage.Play(like, kWindowTicks);
      good = is_good(window);
    }
    if (good) break;
  }
  run.stage.SetRate(run.options.rate_Hz);
  return window;
}

std::string AnsweredText(const Role& role, const Window& window) {
  const auto answered = [&window](const node::TopicInfo& topic) {
    return topic.name + " " + std::to_string(window.Answered(topic.name));
  };
  return types::Joined(role.must_write, ", ", answered) + " of " + std::to_string(window.ticks) +
         " ticks";
}

bool AnsweredMost(const Role& role, const Window& window) {
  return std::all_of(role.must_write.begin(), role.must_write.end(),
                     [&window](const node::TopicInfo& topic) {
                       return window.Answered(topic.name) >= kMostTicks * window.ticks;
                     });
}

void CheckTicks(RealTimeRun& run) {
  (void)run.stage.Play(run.Disarmed(), kWindowTicks);
  const double period_s = 1.0 / run.options.rate_Hz;
  double median_s = 0.0;
  bool in_time = false;
  for (int i = 0; i < kLatencyWindows && !in_time; ++i) {
    const Window window = run.stage.Play(run.Armed(), kWindowTicks);
    std::vector<double> latencies_s;
    for (const node::TopicInfo& topic : run.role.must_write) {
      for (const Output* output : window.Of(topic.name)) latencies_s.push_back(output->latency_s);
    }
    if (latencies_s.empty()) continue;
    median_s = types::UpperMedian(latencies_s);
    in_time = median_s < period_s;
  }

  std::string fault;
  int outputs = 0;
  const auto is_good = [&](const Window& window) {
    for (const node::TopicInfo& topic : run.role.must_write) {
      if (fault.empty()) fault = TickFault(window, topic.name);
      outputs += static_cast<int>(window.Of(topic.name).size());
    }
    return AnsweredMost(run.role, window);
  };
  const Window window = PlayWindows(run, run.Armed(), is_good);
  run.report.Add("answers_every_tick", AnsweredMost(run.role, window),
                 "an output of every topic for " + Percent(kMostTicks) + " of the ticks",
                 AnsweredText(run.role, window));
  run.report.Add("tick_and_session", fault.empty() && outputs > 0,
                 "an output has session and tick of its joint_state, each tick once, in order",
                 !fault.empty() ? fault
                 : outputs == 0 ? "no outputs"
                                : std::to_string(outputs) + " outputs");
  run.report.Add(
      "answers_within_a_cycle", in_time,
      "half of the outputs within " + std::to_string(std::lround(1e6 * period_s)) + " us",
      median_s == 0.0 ? "no outputs"
                      : "median " + std::to_string(std::lround(1e6 * median_s)) + " us");
}

}  // namespace sinew::conform
