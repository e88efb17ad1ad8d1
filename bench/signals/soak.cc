#include "bench/signals/soak.h"

#include <signal.h>
#include <sinew_idl/joint.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "components/base/types/clock/clock.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"

namespace sinew::signals {
namespace {

using namespace std::chrono_literals;

constexpr double kLauncherShare = 0.03;  // of the signals: its end is that of all the others
constexpr double kShortestStop_s = 0.005, kLongestStop_s = 2.0;
constexpr auto kWordPeriod = 250ms;  // between words of the operator
constexpr auto kStuck = 60s;
constexpr auto kSettled = 3s;  // after a launch: who joined together takes its place within 1 s
constexpr auto kEnds = 10s;    // the processes of a launcher that has ended
constexpr double kMoving_ms = 350.0;  // since the newest command: assessed 300 ms later

node::Options WatchOptions(int domain) {
  BecomeWatcher();
  node::Options options;
  options.component = options.name = "observer";
  options.domain_id = domain;
  return options;
}

template <class Message>
bool DecodeSample(const node::RawSample& sample, Message* message) {
  node::Bytes bytes(sample.payload.size());
  std::copy(sample.payload.begin(), sample.payload.end(), bytes.begin());
  return node::Decode(bytes, message);
}

}  // namespace

Soak::Soak(const Wanted& wanted)
    : wanted_(wanted),
      random_(wanted.seed),
      node_(WatchOptions(wanted.domain)),
      operator_(node_.MakeWriter(node::kOperatorCommand)),
      deployment_(wanted.domain, wanted.realtime),
      bus_(deployment_.bus()) {
  outcome_.before = InSharedMemory();
  for (const auto topic :
       {node::kJointState.name, node::kJointCommand.name, node::kCommandSource.name}) {
    node_.ReadRaw(*node::FindTopic(topic), [this](node::RawSample&& sample) {
      const std::lock_guard lock(mutex_);
      samples_.push_back(std::move(sample));
    });
  }
}

Outcome Soak::Run() {
  const auto begin = Clock::now(),
             end = begin + std::chrono::duration_cast<Clock::duration>(
                               std::chrono::duration<double>(wanted_.seconds));
  Log("begins at " + std::to_string(1e-9 * static_cast<double>(types::MonotonicNow_ns())) + " s");
  Launch();
  auto before = began_;
  while (Clock::now() < end) {
    node_.WaitForData(5ms);
    Take();
    bus_.Assess(published_, types::MonotonicNow_ns());
    const auto now = Clock::now();
    if (bus_.WithoutCommand_ms(types::MonotonicNow_ns()) < kMoving_ms) {
      moved_ = now;
      outcome_.moving_s += std::chrono::duration<double>(now - before).count();
    }
    before = now;
    Operate();
    Continue(false);
    SendSignals();
    KeepLaunched();
    if (now > sampled_ + 1s) {
      sampled_ = now;
      std::vector<Target> all = deployment_.Targets();
      if (!all.empty()) known_ = all;
      const std::vector<Target> hardware = deployment_.Hardware();
      all.insert(all.end(), hardware.begin(), hardware.end());
      growth_.Sample(all);
    }
  }
  Continue(true);
  if (!deployment_.Stop()) Note("the last deployment did not end\n" + deployment_.Log());
  outcome_.seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  outcome_.bus = bus_.findings();
  outcome_.grown = growth_.largest();
  outcome_.after = InSharedMemory();
  return outcome_;
}

void Soak::Take() {
  std::vector<node::RawSample> samples;
  {
    const std::lock_guard lock(mutex_);
    samples.swap(samples_);
  }
  msg::JointState state;
  msg::JointCommand command;
  msg::CommandSource source;
  for (const node::RawSample& sample : samples) {
    if (sample.topic == node::kJointState.name) {
      if (!DecodeSample(sample, &state)) continue;
      published_.Add(state, types::MonotonicNow_ns());
      if (state.robot_state != state_.robot_state) {
        Log("state " + std::to_string(static_cast<int>(state.robot_state)));
      }
      state_ = state;
    } else if (sample.topic == node::kJointCommand.name) {
      if (DecodeSample(sample, &command)) published_.Add(command);
    } else if (DecodeSample(sample, &source)) {
      NoteDriver(source.joint_command_participant);
    }
  }
}

void Soak::NoteDriver(const std::string& name) {
  if (name.empty() || name == driver_) return;
  if (!driver_.empty()) {
    ++outcome_.switches;
    const std::string what = "driven by " + name + " instead of " + driver_;
    if (wanted_.signals == 0 && Clock::now() - launched_ > kSettled) {
      Note(what + ", both healthy");
    } else {
      Log(what);
    }
  }
  driver_ = name;
}

void Soak::Operate() {
  const auto now = Clock::now();
  const bool fault = state_.robot_state == msg::RobotState::kFault;
  if (now < next_word_ || !(fault || state_.robot_state == msg::RobotState::kDisarmed)) return;
  next_word_ = now + kWordPeriod;
  msg::OperatorCommand word;
  word.header = state_.header;
  word.action = fault ? msg::OperatorAction::kReset : msg::OperatorAction::kArm;
  (void)operator_.Write(word);
}

void Soak::SendSignals() {
  const auto now = Clock::now();
  if (wanted_.signals == 0 || now < next_signal_) return;
  // Of three signals two are an event's first: a SIGKILL, or a SIGSTOP with its SIGCONT.
  const double mean_s = wanted_.seconds / wanted_.signals * 1.5;
  const double wait_s = std::uniform_real_distribution<double>(0.2, 1.8)(random_) * mean_s;
  next_signal_ =
      now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wait_s));
  std::vector<Target> targets = deployment_.Targets();
  if (targets.size() < 2) return;
  const bool launcher = std::bernoulli_distribution(kLauncherShare)(random_);
  const std::size_t k =
      launcher ? 0 : std::uniform_int_distribution<std::size_t>(1, targets.size() - 1)(random_);
  const Target target = targets[k];
  ++outcome_.signals[target.name];
  if (std::bernoulli_distribution(0.5)(random_)) {
    ++outcome_.kills;
    ::kill(target.pid, SIGKILL);
    Log("SIGKILL " + target.name);
    return;
  }
  ++outcome_.stops;
  const double log_s = std::uniform_real_distribution<double>(std::log(kShortestStop_s),
                                                              std::log(kLongestStop_s))(random_);
  ::kill(target.pid, SIGSTOP);
  Log("SIGSTOP " + target.name + " for " + std::to_string(std::exp(log_s)) + " s");
  stopped_.push_back({now + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(std::exp(log_s))),
                      target});
}

void Soak::Continue(bool all) {
  const auto now = Clock::now();
  std::erase_if(stopped_, [&](const Stopped& stopped) {
    if (!all && now < stopped.until) return false;
    ++outcome_.continues;
    if (testing::IsRunning(stopped.target.pid)) ::kill(stopped.target.pid, SIGCONT);
    return true;
  });
}

void Soak::KeepLaunched() {
  if (deployment_.launched() && Clock::now() - moved_ < kStuck) return;
  if (deployment_.launched()) {
    ++outcome_.stuck;
    Log("stuck\n" + deployment_.Log());
    Continue(true);
    if (!deployment_.Stop()) Note("a deployment did not end\n" + deployment_.Log());
  }
  Continue(true);
  for (const Target& target : deployment_.LeftBehind(known_, kEnds)) {
    Note("left behind by the launcher: " + target.name);
    ::kill(target.pid, SIGKILL);
  }
  Launch();
}

void Soak::Launch() {
  ++outcome_.launches;
  deployment_.Launch();
  moved_ = launched_ = Clock::now();
  driver_.clear();
  next_signal_ = std::max(next_signal_, moved_ + 5s);
}

void Soak::Log(const std::string& what) const {
  const std::chrono::duration<double> since = Clock::now() - began_;
  std::fprintf(stderr, "%9.3f s %s\n", since.count(), what.c_str());
}

void Soak::Note(const std::string& what) {
  Log(what);
  outcome_.violations.push_back(what);
}

}  // namespace sinew::signals
