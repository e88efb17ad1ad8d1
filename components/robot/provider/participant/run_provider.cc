#include "components/robot/provider/participant/run_provider.h"

#include <semaphore.h>
#include <sinew_idl/estop.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/clock/clock.h"
#include "components/base/types/fault.h"
#include "components/robot/estop/watch.h"
#include "components/robot/provider/cycle_deadline.h"
#include "components/robot/provider/participant/command_readers.h"
#include "components/robot/provider/participant/estop_desk.h"
#include "components/robot/provider/participant/lockstep_wait.h"
#include "components/robot/provider/participant/other_provider.h"
#include "components/robot/provider/participant/state_publisher.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/robot/provider/work_time.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/cut_off.h"
#include "components/topics/node/node.h"
#include "components/topics/node/realtime.h"
#include "components/topics/node/topics.h"

namespace sinew::provider {

namespace {

// Answers of a topic whose messages the provider does not read itself.
std::function<std::uint64_t()> CountAnswers(const std::string& topic, std::uint64_t session_id,
                                            node::Node& node) {
  auto answered = std::make_shared<std::atomic<std::uint64_t>>(0);
  node.ReadRaw(*node::FindTopic(topic), [answered, session_id](node::RawSample&& sample) {
    node::HeadOfMessage head;
    if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
    if (head.session_id == session_id) answered->store(head.tick + 1);
  });
  return [answered] { return answered->load(); };
}

// The topics of --await joined to the provider's readers, for LockstepWait. Thread: the provider's
// loop; messages of other topics are counted in DDS threads.
// The result refers to node, cycle and readers, which must outlive it. Throws UsageError
// (ParseAwaited) and DdsError.
std::vector<AwaitedTopic> MakeAwaitedTopics(const std::vector<std::string>& await, node::Node& node,
                                            const ProviderCycle& cycle, CommandReaders& readers) {
  std::vector<AwaitedTopic> topics;
  for (const std::string& text : await) {
    AwaitedTopic topic = ParseAwaited(text);
    if (topic.topic == node::kJointCommand.name) {
      topic.answers = [&cycle] { return cycle.joint_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForJointCommand(timeout); };
    } else if (topic.topic == node::kValveCommand.name) {
      topic.answers = [&cycle] { return cycle.valve_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForValveCommand(timeout); };
    } else if (topic.topic == node::kSimPressure.name) {
      if (!readers.simulated()) {
        throw UsageError("--await: hardware reads no sim_pressure, expected a simulated robot");
      }
      topic.answers = [&readers] { return readers.pressure_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForPressure(timeout); };
    } else if (topic.topic == node::kSimBodyDisturbance.name) {
      if (!readers.has_body()) {
        throw UsageError("--await: a robot on a fixed base reads no sim_body_disturbance");
      }
      topic.answers = [&readers] { return readers.body_disturbance_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForBodyDisturbance(timeout); };
    } else {
      topic.answers = CountAnswers(topic.topic, cycle.session_id(), node);
      topic.wait = [&node](auto timeout) { node.WaitForData(timeout); };
    }
    topics.push_back(std::move(topic));
  }
  return topics;
}

// The sleep of a cycle until its deadline, which another thread can end.
//
// Threads: one sleeps, any wakes. Neither allocates.
class CycleSleep {
 public:
  CycleSleep() { ::sem_init(&semaphore_, 0, 0); }
  ~CycleSleep() { ::sem_destroy(&semaphore_); }
  CycleSleep(const CycleSleep&) = delete;
  CycleSleep& operator=(const CycleSleep&) = delete;

  void Wake() noexcept { ::sem_post(&semaphore_); }

  // Until this time of CLOCK_MONOTONIC. False: it came. True: woken before, now or since the last
  // sleep, or by a signal.
  bool Until(std::int64_t deadline_ns) noexcept {
    const timespec deadline{deadline_ns / 1'000'000'000,
                            static_cast<long>(deadline_ns % 1'000'000'000)};
    return ::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &deadline) == 0 || errno == EINTR;
  }

 private:
  sem_t semaphore_;
};

using std::chrono::milliseconds;
using types::MonotonicNow_ns;
using types::RobotState;
using Clock = std::chrono::steady_clock;

std::uint64_t RandomSession() {
  std::random_device device;
  return ((static_cast<std::uint64_t>(device()) << 32) | device()) | 1u;
}

void CheckFallGuard(const FallGuardConfig& fall, const Plant& plant, double rate_Hz) {
  if (plant.body_sensors() == nullptr) {
    throw UsageError(
        "guard.fall: this robot measures neither feet nor torso, expected sensors of "
        "the body or no such section");
  }
  if (fall.joint_count != plant.joint_count()) {
    throw UsageError("guard.fall: the URDF has " + std::to_string(fall.joint_count) +
                     " driven joints and the robot " + std::to_string(plant.joint_count()));
  }
  try {
    (void)FallGuard(fall, 1.0 / rate_Hz);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("guard.fall: ") + error.what());
  }
}

CycleConfig MakeCycleConfig(const node::Options& node_options, const ProviderOptions& options,
                            const GuardConfig& guard, const Plant& plant,
                            const estop::Config& estop) {
  if (options.arm && plant.live()) {
    throw UsageError("--arm: hardware is armed by an operator, with 'sinew arm'");
  }
  if (options.composed != nullptr && node_options.mode == node::TimeMode::kLockstep) {
    throw UsageError("--lockstep: a composition runs in real time, expected separate processes");
  }
  if (!estop.required.empty() && node_options.mode == node::TimeMode::kLockstep) {
    throw UsageError("estop.required: a lockstep run has no time in which an estop may be silent");
  }
  if (!estop.required.empty() && options.arm) {
    throw UsageError("--arm: refused: estop.required, and nobody can have watched it yet");
  }
  if (guard.fall != nullptr) CheckFallGuard(*guard.fall, plant, options.rate_Hz);
  CycleConfig config;
  config.guard = guard;
  config.guard.live = plant.live();
  config.simulated_time = node_options.mode == node::TimeMode::kLockstep;
  config.ages_by_clock = !config.simulated_time && plant.acts_at_once();
  config.session_id = config.simulated_time ? SessionFromSeed(node_options.seed) : RandomSession();
  config.joint_count = plant.joint_count();
  config.rate_Hz = options.rate_Hz;
  config.duration_s = options.duration_s;
  config.estop_is_latched = estop.latch.has_value();
  config.plant_may_be_armed = plant.ArmRefusal().empty();
  config.arm_needs_answers = !config.simulated_time && (options.arm || plant.live());
  if (options.arm && !config.plant_may_be_armed) {
    throw UsageError("--arm: refused: " + plant.ArmRefusal());
  }
  return config;
}

constexpr char kUnanswered[] = "no joint_command answers: is the controller running (sinew list)?";

// The plant's or the fall guard's message of its own faults, joints' included; of others what is
// known here, and then the former.
std::string Message(const types::Fault& fault, std::string_view own) {
  if (own.empty()) return types::FaultText(fault);
  const bool is_own = !fault.active() || fault.cause >= types::FaultCause::kFall;
  return (is_own ? "" : types::FaultText(fault) + "; ") + std::string(own);
}

class Provider {
 public:
  Provider(const node::Options& node_options, node::StopFlag& stop, const ProviderOptions& options,
           const GuardConfig& guard, Plant& plant, const estop::Config& estop)
      : stop_(stop),
        options_(options),
        plant_(plant),
        estop_config_(estop),
        lockstep_(node_options.mode == node::TimeMode::kLockstep),
        cycle_(MakeCycleConfig(node_options, options, guard, plant, estop)),
        node_(node_options),
        publisher_(node_, plant),
        readers_(node_, cycle_, plant,
                 [this](OperatorResult result, types::OperatorAction action,
                        std::string_view reason) { return OnOperator(result, action, reason); }),
        wait_(MakeAwaitedTopics(options.await, node_, cycle_, readers_), options.await_timeout_s),
        work_(options.work != nullptr ? *options.work : own_work_) {
    if (!estop.required.empty()) estop_states_.emplace(node_.MakeReader(node::kEstopState));
  }

  void Run() {
    // A refused provider sends nothing: the plant is the other one's.
    other_provider_.Refuse(milliseconds(lockstep_ ? 300 : 700), stop_);
    node::BeginRealtime();
    desk_.emplace(estop_config_, cycle_, plant_, [this] {
      node_.Wake();
      sleep_.Wake();
    });
    if (estop_states_) watch_.emplace(estop_config_.required, MonotonicNow_ns());
    // Motors off before anything else ends, after an exception too.
    const struct MotorsOff {
      Plant& plant;
      ~MotorsOff() { plant.ShutDown(); }
    } motors_off{plant_};
    plant_.Reset(&sensors_);
    if (options_.stepped) options_.stepped(0.0, sensors_);
    node_.SetPeriod(cycle_.period());
    arm_is_due_ = options_.arm && !cycle_.ArmAtStart();
    node_.SetState(node::Node::State::kActive,
                   arm_is_due_ ? std::string("--arm waits: ") + kUnanswered : "");
    const auto start = Clock::now();
    CycleDeadline deadline(cycle_.period(), MonotonicNow_ns());
    for (tick_ = 0; !stop_.requested(); ++tick_) {
      const std::int64_t begin_ns = MonotonicNow_ns();
      work_.Resume(begin_ns);
      (void)cycle_.Begin(tick_, begin_ns);  // a stall is reported with the cycle
      TakeOperatorCommands();
      ArmWhenAnswered();
      if (!lockstep_) other_provider_.Watch({cycle_.session_id(), cycle_.period_s() * tick_});
      Publish();
      if (options_.composed != nullptr) options_.composed->Answer();
      const PlantCommand* command = nullptr;
      if (lockstep_) {
        if (!wait_.Answers(tick_, waiting_)) break;
      } else {
        command = PassRealTime(&deadline);
      }
      TakeAll();
      if (command == nullptr) command = &MakeCommand();
      plant_.Step(*command, cycle_.period_s(), &sensors_);
      desk_->CommandSent();
      if (options_.stepped) {
        options_.stepped(static_cast<double>(tick_ + 1) * cycle_.period_s(), sensors_);
      }
      if (cycle_.Observe(sensors_) == FaultChange::kJoint) {
        spdlog::warn("tick {}: {}", tick_, sensors_.message);
      }
      if (cycle_.falls()) (void)cycle_.ObserveBody(tick_, sensors_, *plant_.body_sensors());
      Report();
      work_.Pause(MonotonicNow_ns());
      work_.EndCycle();
      if (cycle_.last(tick_)) break;
    }
    if (lockstep_ && cycle_.last(tick_)) (void)wait_.AllAnswers(tick_, waiting_);
    LogEnd(std::chrono::duration<double>(Clock::now() - start).count(), deadline.overruns());
  }

 private:
  // --arm in real time: while handshakes are not done, its first commands would be missing.
  void ArmWhenAnswered() {
    if (!arm_is_due_) return;
    arm_is_due_ = cycle_.state() == RobotState::kDisarmed && !cycle_.ArmAtStart(tick_);
    if (!arm_is_due_ || cycle_.period_s() * static_cast<double>(tick_) < options_.await_timeout_s) {
      return;
    }
    arm_is_due_ = false;
    const std::string why =
        ArmRefusal(cycle_.CommandFault().active() ? OperatorResult::kRefusedByCommand
                                                  : OperatorResult::kRefusedUnanswered);
    spdlog::error("--arm: not armed within {:.0f} s: {}", options_.await_timeout_s, why);
    node_.SetState(node::Node::State::kActive, "--arm: not armed: " + why);
  }

  // Why the command was refused, where the result does not say it all.
  std::string OnOperator(OperatorResult result, types::OperatorAction action,
                         std::string_view reason) {
    if (result == OperatorResult::kDone) arm_is_due_ = false;  // armed, disarmed or stopped
    if (action == types::OperatorAction::kEstop) desk_->OnEstop(reason);
    if (result == OperatorResult::kUnlatchFirst) desk_->OnReset();
    const std::string why = ArmRefusal(result);
    if (why.empty()) return "";
    node_.SetState(node::Node::State::kActive, "arm refused: " + why);
    return "arm refused: " + why;
  }

  // The reason of the refusal; empty: it was not refused.
  std::string ArmRefusal(OperatorResult result) const {
    switch (result) {
      case OperatorResult::kRefusedByPlant:
        return plant_.ArmRefusal();
      case OperatorResult::kRefusedByFallGuard:
        return cycle_.FallRefusal();
      case OperatorResult::kRefusedByCommand:
        return types::FaultText(cycle_.CommandFault());
      case OperatorResult::kRefusedByEstop:
        return watch_->Problem(MonotonicNow_ns());
      case OperatorResult::kRefusedUnanswered:
        return kUnanswered;
      default:
        return "";
    }
  }

  // A robot whose estop nobody watches, or whose button is held, is stopped and not armed.
  void WatchEstops() {
    if (!watch_) return;
    const std::int64_t now_ns = MonotonicNow_ns();
    while (const auto state = estop_states_->TakeNext()) {
      if (!cycle_.Admits(state->header)) continue;  // a recording's, an old one
      watch_->Hear(state->name.c_str(), state->stops, state->why.c_str(), now_ns);
    }
    const std::string problem = watch_->Problem(now_ns);
    cycle_.SetEstopsWatched(problem.empty());
    if (problem.empty() || !types::MayMove(cycle_.state())) return;
    spdlog::error("tick {}: estop: {}", tick_, problem);
    (void)cycle_.Take({.action = types::OperatorAction::kEstop}, tick_);
    desk_->OnEstop(problem);
  }

  void TakeOperatorCommands() {
    WatchEstops();
    desk_->Take(tick_);
    readers_.TakeOperatorCommands(tick_);
    IdleAfterEstop();
  }

  void TakeAll() {
    WatchEstops();
    desk_->Take(tick_);
    readers_.TakeAll(tick_);
    IdleAfterEstop();
  }

  // A plant that acts at once does not wait for the next command to be idled.
  void IdleAfterEstop() {
    if (cycle_.state() != RobotState::kEstopped) {
      idled_ = false;
    } else if (!idled_ && plant_.acts_at_once() && !lockstep_) {
      plant_.Act(MakeCommand(), cycle_.period_s());
      desk_->CommandSent();
    }
  }

  const PlantCommand& MakeCommand() {
    desk_->CommandMade();
    idled_ = cycle_.state() == RobotState::kEstopped;
    return cycle_.Command(tick_, sensors_, MonotonicNow_ns());
  }

  void Publish() {
    const types::MessageHeader header = cycle_.Header(tick_, types::EpochNow_ns());
    readers_.PublishSource(header);
    node_.SetCycle(header.session_id, header.tick, header.stamp_ns, header.origin);
    publisher_.Publish(header, cycle_.state(), cycle_.fault(), cycle_.last(tick_),
                       cycle_.period_s(), sensors_);
  }

  // Sleeps until the cycle's deadline. A plant that acts at once gets its command before that; the
  // command, or null.
  const PlantCommand* PassRealTime(CycleDeadline* deadline) {
    const std::int64_t end_ns = deadline->Next();
    const PlantCommand* command = nullptr;
    if (plant_.acts_at_once()) {
      // An overdue command is not waited for: the gap is bridged on time.
      const std::int64_t period_ns = cycle_.period().count();
      const auto cut_off_ns =
          static_cast<std::int64_t>(node::kProviderCutOff * static_cast<double>(period_ns));
      AwaitJointCommand(end_ns - period_ns + (cycle_.Overdue(tick_) ? 0 : cut_off_ns));
      command = &MakeCommand();
      plant_.Act(*command, cycle_.period_s());
      desk_->CommandSent();
    }
    if (options_.composed != nullptr) options_.composed->Finish();
    const std::int64_t now_ns = MonotonicNow_ns();
    work_.Pause(now_ns);
    if (deadline->Missed(now_ns)) {
      ++counts_.missed_ticks;
    } else {
      SleepUntil(end_ns);
    }
    work_.Resume(MonotonicNow_ns());
    return command;
  }

  void AwaitJointCommand(std::int64_t give_up_ns) {
    while (!stop_.requested()) {
      TakeAll();
      if (!cycle_.AwaitsCommand(tick_)) return NoteAnswer();
      const std::int64_t left_ns = give_up_ns - MonotonicNow_ns();
      if (left_ns <= 0) return;
      work_.Pause(MonotonicNow_ns());
      node_.WaitForData(std::chrono::microseconds(left_ns / 1000 + 1));
      work_.Resume(MonotonicNow_ns());
    }
  }

  void NoteAnswer() {
    if (options_.answers == nullptr || tick_ == 0 || !types::MayMove(cycle_.state())) return;
    options_.answers->Resume(publisher_.written_ns());
    options_.answers->Pause(MonotonicNow_ns());
    options_.answers->EndCycle();
  }

  void SleepUntil(std::int64_t deadline_ns) {
    while (sleep_.Until(deadline_ns) && !stop_.requested()) TakeOperatorCommands();
  }

  // Logs and publishes (component_status) a new state of the robot, or a new message of the plant
  // or of the fall guard.
  void Report() {
    ++counts_.cycles;
    counts_.write_failures = publisher_.write_failures();
    const RobotState state = cycle_.state();
    const std::string_view fall = cycle_.fall_message();
    const std::string_view own = fall.empty() ? std::string_view(sensors_.message) : fall;
    if (state != reported_state_ || own != reported_own_) {
      reported_state_ = state;
      reported_own_ = own;
      const std::string message = Message(cycle_.fault(), own);
      spdlog::info("tick {}: {}{}{}", tick_, NameOf(state), message.empty() ? "" : ": ", message);
      node_.SetState(state == RobotState::kFault || state == RobotState::kEstopped
                         ? node::Node::State::kFault
                         : node::Node::State::kActive,
                     message.empty() ? NameOf(state) : message, cycle_.fault());
    }
    if (cycle_.upright() != reported_upright_) {
      reported_upright_ = !reported_upright_;
      spdlog::info("tick {}: fall detector: {}", tick_,
                   reported_upright_ ? "upright" : "not upright");
    }
    if (!lockstep_ || (counts_.cycles & 63u) == 0) node_.SetCounts(counts_);
  }

  void LogEnd(double seconds, std::uint64_t overruns) const {
    const std::uint64_t done = tick_ + (cycle_.last(tick_) ? 1 : 0);
    const double simulated_s = static_cast<double>(done) * cycle_.period_s();
    spdlog::info(
        "{} ticks, {:.1f} s in {:.1f} s ({:.1f} x real time), {} overruns, {} commands refused",
        tick_, simulated_s, seconds, simulated_s / std::max(seconds, 1e-9), overruns,
        cycle_.refused());
    if (!lockstep_ && work_.cycles() > 0) {
      spdlog::info("work of a cycle, topics included: median {:.0f} us, 99.9 % {:.0f} us",
                   work_.Quantile_us(0.5), work_.Quantile_us(0.999));
    }
  }

  node::StopFlag& stop_;
  const ProviderOptions& options_;
  Plant& plant_;
  const estop::Config& estop_config_;
  bool lockstep_;
  ProviderCycle cycle_;
  node::Node node_;
  OtherProvider other_provider_{node_};
  StatePublisher publisher_;
  CommandReaders readers_;
  LockstepWait wait_;
  LockstepWait::Caller waiting_{[this] { TakeAll(); }, [this] { return stop_.requested(); }};
  std::uint64_t tick_ = 0;
  CycleSleep sleep_;
  std::optional<estop::Watch> watch_;  // of estop.required
  std::optional<node::Reader<msg::EstopState>> estop_states_;
  std::optional<EstopDesk> desk_;  // while the loop runs; its thread uses node and sleep
  bool arm_is_due_ = false;        // --arm, which nobody has answered yet
  bool idled_ = false;             // the plant's command is of ESTOPPED
  WorkTime own_work_;
  WorkTime& work_;  // of real-time cycles
  PlantSensors sensors_;
  node::Node::Counts counts_;
  RobotState reported_state_ = RobotState::kDisarmed;
  std::string reported_own_;  // message of the plant or of the fall guard
  bool reported_upright_ = false;
};

}  // namespace

void RunProvider(const node::Options& node_options, node::StopFlag& stop,
                 const ProviderOptions& options, const GuardConfig& guard, Plant& plant,
                 const estop::Config& estop) {
  Provider(node_options, stop, options, guard, plant, estop).Run();
}

}  // namespace sinew::provider
