#include "components/provider/participant/run_provider.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/sensors.h>
#include <sinew_idl/simulation.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "components/node/codec.h"
#include "components/node/node.h"
#include "components/provider/simulated_plant.h"
#include "components/provider/work_time.h"
#include "components/types/clock/clock.h"
#include "components/types/control_mode.h"
#include "components/types/robot_state.h"

namespace sinew::provider {

namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using types::ControlMode;
using types::EpochNow_ns;
using types::MonotonicNow_ns;
using types::Origin;
using types::RobotState;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kNever = ~std::uint64_t{0};

// A topic whose answers bound the provider's lead in lockstep.
struct Awaited {
  std::string topic;
  std::uint64_t window = 0;
  std::shared_ptr<std::atomic<std::uint64_t>> answered;  // newest tick + 1; 0: none yet
};

// splitmix64: spreads a small seed over a session id.
std::uint64_t SessionFromSeed(std::uint64_t seed) {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return (z ^ (z >> 31)) | 1u;
}

std::uint64_t RandomSession() {
  std::random_device device;
  return ((static_cast<std::uint64_t>(device()) << 32) | device()) | 1u;
}

msg::RobotState ToMessage(RobotState state) {
  switch (state) {
    case RobotState::kDisarmed:
      return msg::ROBOT_DISARMED;
    case RobotState::kArmed:
      return msg::ROBOT_ARMED;
    case RobotState::kDamped:
      return msg::ROBOT_DAMPED;
    case RobotState::kFault:
      return msg::ROBOT_FAULT;
    case RobotState::kEstopped:
      return msg::ROBOT_ESTOPPED;
  }
  return msg::ROBOT_FAULT;
}

Origin FromMessage(msg::Origin origin) {
  switch (origin) {
    case msg::ORIGIN_LIVE:
      return Origin::kLive;
    case msg::ORIGIN_SIM:
      return Origin::kSim;
    case msg::ORIGIN_REPLAY:
      return Origin::kReplay;
  }
  return Origin::kReplay;
}

ControlMode FromMessage(msg::CommandMode mode) {
  switch (mode) {
    case msg::COMMAND_IDLE:
      return ControlMode::kIdle;
    case msg::COMMAND_TORQUE:
      return ControlMode::kTorque;
    case msg::COMMAND_POSITION:
      return ControlMode::kPosition;
    case msg::COMMAND_VELOCITY:
      return ControlMode::kVelocity;
  }
  return ControlMode::kIdle;
}

class Provider {
 public:
  Provider(const node::Options& node_options, node::StopFlag& stop, const ProviderOptions& options,
           const GuardConfig& guard, Plant& plant)
      : stop_(stop),
        options_(options),
        guard_config_(guard),
        guard_(guard),
        plant_(plant),
        lockstep_(node_options.mode == node::TimeMode::kLockstep),
        node_(node_options),
        joint_state_(node_.MakeWriter(node::kJointState)),
        actuator_state_(node_.MakeWriter(node::kActuatorState)),
        joint_command_(node_.MakeReader(node::kJointCommand)),
        valve_command_(node_.MakeReader(node::kValveCommand)),
        operator_command_(node_.MakeReader(node::kOperatorCommand)),
        simulated_(dynamic_cast<SimulatedPlant*>(&plant)) {
    if (simulated_ != nullptr) disturbance_.emplace(node_.MakeReader(node::kSimDisturbance));
    if (options.arm && plant.live()) {
      throw UsageError("--arm: hardware is armed by an operator, with 'sinew arm'");
    }
    session_id_ = lockstep_ ? SessionFromSeed(node_options.seed) : RandomSession();
    for (const std::string& text : options.await) AddAwaited(text);
    if (plant.bus_report() != nullptr) bus_status_.emplace(node_.MakeWriter(node::kBusStatus));
    if (plant.body_sensors() != nullptr) {
      foot_force_.emplace(node_.MakeWriter(node::kFootForce));
      imu_.emplace(node_.MakeWriter(node::kImu));
    }
    guard_.StartSession(session_id_);
    period_ = nanoseconds(std::llround(1e9 / options.rate_Hz));
    period_s_ = 1.0 / options.rate_Hz;
    if (options.duration_s > 0.0) {
      last_tick_ =
          static_cast<std::uint64_t>(std::llround(options.duration_s * options.rate_Hz)) - 1;
    }
  }

  void Run() {
    RefuseSecondProvider();
    plant_.Reset(&sensors_);
    if (options_.arm) guard_.Arm(session_id_, 0);
    node_.SetState(node::Node::State::kActive);
    const auto start = Clock::now();
    std::int64_t deadline_ns = MonotonicNow_ns();
    for (tick_ = 0; !stop_.requested(); ++tick_) {
      work_.Resume(MonotonicNow_ns());
      TakeOperatorCommands();
      Publish();
      if (lockstep_) {
        if (!AwaitAnswers()) break;
      } else {
        deadline_ns += period_.count();
        if (plant_.acts_at_once()) {
          // What is overdue is waited for no longer: the gap is bridged on time.
          const std::int64_t wait_ns =
              guard_.Overdue(tick_) ? period_.count() : period_.count() / 2;
          AwaitJointCommand(deadline_ns - wait_ns);
          plant_.Act(Assess(), period_s_);
        }
        work_.Pause(MonotonicNow_ns());
        SleepUntil(&deadline_ns);
        work_.Resume(MonotonicNow_ns());
      }
      TakeCommands();
      if (lockstep_ || !plant_.acts_at_once()) Assess();
      plant_.Step(command_, period_s_, &sensors_);
      AssessFaults();
      Report();
      work_.Pause(MonotonicNow_ns());
      work_.EndCycle();
      if (tick_ == last_tick_) break;
    }
    if (lockstep_ && tick_ == last_tick_) AwaitRecorders();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const double simulated = static_cast<double>(tick_ + (tick_ == last_tick_ ? 1 : 0)) * period_s_;
    spdlog::info(
        "{} ticks, {:.1f} s in {:.1f} s ({:.1f} x real time), {} overruns, {} commands refused",
        tick_, simulated, seconds, simulated / std::max(seconds, 1e-9), overruns_,
        guard_.refused());
    if (!lockstep_ && work_.cycles() > 0) {
      spdlog::info("work of a cycle, topics included: median {:.0f} us, 99.9 % {:.0f} us",
                   work_.Quantile_us(0.5), work_.Quantile_us(0.999));
    }
  }

 private:
  void AddAwaited(const std::string& text) {
    Awaited awaited;
    const std::size_t colon = text.find(':');
    awaited.topic = text.substr(0, colon);
    const node::TopicInfo* topic = node::FindTopic(awaited.topic);
    if (topic == nullptr) throw UsageError("--await: no topic '" + awaited.topic + "'");
    if (colon != std::string::npos) {
      int window = -1;
      try {
        window = std::stoi(text.substr(colon + 1));
      } catch (const std::exception&) {
      }
      if (window < 0 || window > 128) {
        throw UsageError("--await: '" + text +
                         "', expected TOPIC:WINDOW with a window from 0 to 128 ticks");
      }
      awaited.window = static_cast<std::uint64_t>(window);
    }
    if (awaited.topic == node::kJointCommand.name) {
      awaited.answered = joint_answered_;  // counted where the command is taken
    } else if (awaited.topic == node::kValveCommand.name) {
      awaited.answered = valve_answered_;
    } else {
      awaited.answered = std::make_shared<std::atomic<std::uint64_t>>(0);
      node_.ReadRaw(*topic,
                    [answered = awaited.answered, session = session_id_](node::RawSample&& sample) {
                      node::HeadOfMessage head;
                      if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head))
                        return;
                      if (head.session_id == session) answered->store(head.tick + 1);
                    });
    }
    awaited_.push_back(std::move(awaited));
  }

  // One provider a domain: another one's joint_state would mix with ours.
  void RefuseSecondProvider() {
    const auto deadline = Clock::now() + milliseconds(lockstep_ ? 300 : 700);
    while (Clock::now() < deadline && !stop_.requested()) {
      for (const node::Endpoint& endpoint : node_.Endpoints()) {
        if (endpoint.is_writer && endpoint.topic == node::kJointState.name) {
          throw UsageError("domain " + std::to_string(node_.options().domain_id) +
                           " already has a state provider: '" + endpoint.participant +
                           "'; stop it or use another --domain");
        }
      }
      node_.WaitForData(milliseconds(50));
    }
  }

  void FillHeader(msg::Header* header) const {
    header->session_id(session_id_);
    header->tick(tick_);
    header->stamp_ns(stamp_ns_);
    header->origin(plant_.live() ? msg::ORIGIN_LIVE : msg::ORIGIN_SIM);
  }

  void Publish() {
    stamp_ns_ = lockstep_ ? static_cast<std::int64_t>(
                                std::llround(static_cast<double>(tick_) * 1e9 / options_.rate_Hz))
                          : EpochNow_ns();
    const int joints = plant_.joint_count();
    FillHeader(&state_.header());
    node_.SetCycle(session_id_, tick_, stamp_ns_, static_cast<int>(state_.header().origin()));
    state_.robot_state(ToMessage(guard_.state()));
    state_.last_tick(tick_ == last_tick_);
    state_.period_s(period_s_);
    state_.joint_count(static_cast<std::uint8_t>(joints));
    for (std::size_t j = 0; j < static_cast<std::size_t>(joints); ++j) {
      state_.joint_kind()[j] =
          plant_.prismatic(static_cast<int>(j)) ? msg::JOINT_PRISMATIC : msg::JOINT_REVOLUTE;
    }
    state_.position_rad(sensors_.position_rad);
    state_.velocity_rad_s(sensors_.velocity_rad_s);
    state_.torque_Nm(sensors_.torque_Nm);
    state_.age_us(sensors_.age_us);
    state_.valid(sensors_.valid);
    FillHeader(&actuator_.header());
    actuator_.joint_count(static_cast<std::uint8_t>(joints));
    actuator_.motor_position_rad(sensors_.motor_position_rad);
    actuator_.motor_velocity_rad_s(sensors_.motor_velocity_rad_s);
    actuator_.motor_current_A(sensors_.motor_current_A);
    actuator_.drive_voltage_V(sensors_.drive_voltage_V);
    actuator_.motor_temperature_degC(sensors_.motor_temperature_degC);
    actuator_.chamber_pressure_bar(sensors_.chamber_pressure_bar);
    actuator_.reservoir_pressure_bar(sensors_.reservoir_pressure_bar);
    actuator_.load_force_N(sensors_.load_force_N);
    actuator_.declared_payload_kg(sensors_.declared_payload_kg);
    actuator_.valve_open(sensors_.valve_open);
    actuator_.valid(sensors_.valid);
    actuator_.measured_flags(plant_.measured_flags());
    // actuator_state first: joint_state is the trigger of every loop.
    Count(actuator_state_.Write(actuator_));
    if (foot_force_) PublishBody();
    Count(joint_state_.Write(state_));
    if (bus_status_) PublishBus();
  }

  void PublishBody() {
    const BodySensors& body = *plant_.body_sensors();
    msg::FootForce feet;
    FillHeader(&feet.header());
    feet.force_N(body.foot_force_N);
    feet.valid(body.foot_valid);
    Count(foot_force_->Write(feet));
    msg::Imu imu;
    FillHeader(&imu.header());
    imu.acceleration_m_s2(body.acceleration_m_s2);
    imu.angular_velocity_rad_s(body.angular_velocity_rad_s);
    imu.orientation_wxyz(body.orientation_wxyz);
    imu.valid(body.imu_valid);
    Count(imu_->Write(imu));
  }

  void PublishBus() {
    const BusReport& report = *plant_.bus_report();
    msg::BusStatus status;
    FillHeader(&status.header());
    status.bus_count(static_cast<std::uint8_t>(report.bus_count));
    status.up(report.up);
    status.frames_sent(report.frames_sent);
    status.frames_received(report.frames_received);
    status.frames_dropped(report.frames_dropped);
    status.frames_lost(report.frames_lost);
    status.error_frames(report.error_frames);
    status.load_percent(report.load_percent);
    status.answer_p50_us(report.answer_p50_us);
    status.answer_max_us(report.answer_max_us);
    status.cycle_p50_us(report.cycle_p50_us);
    status.cycle_max_us(report.cycle_max_us);
    Count(bus_status_->Write(status));
  }

  void Count(node::WriteStatus status) {
    if (status != node::WriteStatus::kOk) ++counts_.write_failures;
  }

  void TakeOperatorCommands() {
    while (const auto command = operator_command_.TakeNext()) {
      switch (command->action()) {
        case msg::OPERATOR_ARM:
          if (!guard_.Arm(command->header().session_id(), tick_)) {
            spdlog::warn("arm refused: {}", guard_.state() == RobotState::kFault ||
                                                    guard_.state() == RobotState::kEstopped
                                                ? "reset first"
                                                : "meant for another session");
          }
          break;
        case msg::OPERATOR_DISARM:
          guard_.Disarm();
          break;
        case msg::OPERATOR_ESTOP:
          guard_.Estop();
          break;
        case msg::OPERATOR_RESET:
          if (guard_.state() == RobotState::kArmed || guard_.state() == RobotState::kDamped) {
            // A joint that had dropped out would join in at once.
            spdlog::warn("reset refused: disarm first");
            break;
          }
          plant_.ClearFault();
          faulty_joints_ = 0;
          guard_.Reset();
          break;
        case msg::OPERATOR_START:
        case msg::OPERATOR_STOP:
          break;  // for reference generators
      }
      spdlog::info("operator: action {}, reason '{}'", static_cast<int>(command->action()),
                   command->reason());
    }
    if (simulated_ == nullptr) return;
    while (const auto disturbance = disturbance_->TakeNext()) {
      simulated_->Disturb({disturbance->load_force_N(), disturbance->payload_kg()});
    }
  }

  void TakeCommands() {
    TakeOperatorCommands();
    while (auto command = joint_command_.TakeNext()) {
      const CommandHead head{command->header().session_id(), command->header().tick(),
                             FromMessage(command->header().origin())};
      if (head.session_id == session_id_) joint_answered_->store(head.tick + 1);
      if (guard_.Offer(head, tick_)) accepted_ = std::move(*command);
    }
    while (auto command = valve_command_.TakeNext()) {
      const msg::Header& head = command->header();
      if (head.session_id() == session_id_) valve_answered_->store(head.tick() + 1);
      const bool counts = head.session_id() == session_id_ && head.tick() <= tick_ &&
                          (!plant_.live() || head.origin() == msg::ORIGIN_LIVE);
      if (counts) {
        valves_ = std::move(*command);
        valve_tick_ = valves_.header().tick();
      }
    }
  }

  // A joint's fault is told once; the robot's ends what moves.
  void AssessFaults() {
    const auto joints = static_cast<std::size_t>(plant_.joint_count());
    const auto begin = sensors_.joint_fault.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(joints);
    const auto faulty = std::count(begin, end, true);
    if (sensors_.fault || faulty == plant_.joint_count()) {
      guard_.Fault();
    } else if (faulty > faulty_joints_) {
      guard_.JointFault();
      spdlog::warn("tick {}: {}", tick_, sensors_.message);
    }
    faulty_joints_ = faulty;
  }

  const PlantCommand& Assess() {
    const Verdict verdict = guard_.Step(tick_, period_);
    const auto joints = static_cast<std::size_t>(plant_.joint_count());
    for (std::size_t j = 0; j < joints; ++j) {
      command_.motor_torque_Nm[j] = 0.0;
      switch (sensors_.joint_fault[j] ? Verdict::kIdle : verdict) {
        case Verdict::kIdle:
          command_.mode[j] = ControlMode::kIdle;
          break;
        case Verdict::kPass:
          command_.mode[j] =
              j < accepted_.joint_count() ? FromMessage(accepted_.mode()[j]) : ControlMode::kIdle;
          command_.motor_torque_Nm[j] = accepted_.motor_torque_Nm()[j];
          command_.position_rad[j] = accepted_.position_rad()[j];
          command_.velocity_rad_s[j] = accepted_.velocity_rad_s()[j];
          if (!std::isfinite(command_.motor_torque_Nm[j]) ||
              !std::isfinite(command_.position_rad[j]) ||
              !std::isfinite(command_.velocity_rad_s[j])) {
            guard_.Fault();
            command_.mode[j] = ControlMode::kIdle;
            command_.motor_torque_Nm[j] = 0.0;
          }
          break;
        case Verdict::kHold:
          if (!holding_) command_.position_rad[j] = sensors_.position_rad[j];
          command_.mode[j] = ControlMode::kPosition;
          command_.velocity_rad_s[j] = 0.0;
          break;
        case Verdict::kDamp:
          command_.mode[j] = ControlMode::kTorque;
          command_.motor_torque_Nm[j] =
              -guard_config_.damping_Nm_s_rad * sensors_.motor_velocity_rad_s[j];
          break;
      }
      // Relays follow their manager only while it is heard; their safe state is off.
      const bool heard = valve_tick_ != kNever && !TooOld(valve_tick_) && j < valves_.joint_count();
      command_.valve_open[j] = heard && valves_.valve_open()[j];
      command_.compressor_on[j] = heard && valves_.compressor_on()[j];
      command_.vent_open[j] = heard && valves_.vent_open()[j];
    }
    holding_ = verdict == Verdict::kHold;
    return command_;
  }

  bool TooOld(std::uint64_t tick) const {
    return static_cast<std::int64_t>(tick_ - tick) * period_ > guard_config_.fault_after;
  }

  // False: stop was requested.
  bool AwaitAnswers() {
    for (const Awaited& awaited : awaited_) {
      if (tick_ < awaited.window) continue;
      if (!AwaitTick(awaited, tick_ - awaited.window)) return false;
    }
    return true;
  }

  bool AwaitTick(const Awaited& awaited, std::uint64_t tick) {
    const auto give_up = Clock::now() + std::chrono::duration<double>(options_.await_timeout_s);
    while (true) {
      TakeCommands();
      if (awaited.answered->load() >= tick + 1) return true;
      if (stop_.requested()) return false;
      if (awaited.answered == joint_answered_) {
        joint_command_.WaitForSample(milliseconds(50));
      } else if (awaited.answered == valve_answered_) {
        valve_command_.WaitForSample(milliseconds(50));
      } else {
        node_.WaitForData(milliseconds(50));
      }
      if (Clock::now() > give_up) {
        throw std::runtime_error("no " + awaited.topic + " for tick " + std::to_string(tick) +
                                 " within " +
                                 std::to_string(static_cast<int>(options_.await_timeout_s)) +
                                 " s; is its writer running, in the same domain and in lockstep?");
      }
    }
  }

  // Until the command for this tick is there, nobody may move, or the time is over.
  void AwaitJointCommand(std::int64_t give_up_ns) {
    while (!stop_.requested()) {
      TakeCommands();
      const RobotState state = guard_.state();
      if (state != RobotState::kArmed && state != RobotState::kDamped) return;
      if (joint_answered_->load() >= tick_ + 1) return;
      const std::int64_t left_ns = give_up_ns - MonotonicNow_ns();
      if (left_ns <= 0) return;
      work_.Pause(MonotonicNow_ns());
      node_.WaitForData(std::chrono::microseconds(left_ns / 1000 + 1));
      work_.Resume(MonotonicNow_ns());
    }
  }

  void AwaitRecorders() {
    for (const Awaited& awaited : awaited_) {
      if (!AwaitTick(awaited, tick_)) return;
    }
  }

  void SleepUntil(std::int64_t* deadline_ns) {
    const std::int64_t late = MonotonicNow_ns() - *deadline_ns;
    if (late > 0) {
      ++overruns_;
      ++counts_.missed_ticks;
      if (late > 10 * period_.count())
        *deadline_ns += late;  // after a long stop: no burst to catch up
      return;
    }
    timespec until{};
    until.tv_sec = *deadline_ns / 1000000000ll;
    until.tv_nsec = *deadline_ns % 1000000000ll;
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR &&
           !stop_.requested()) {
    }
  }

  void Report() {
    ++counts_.cycles;
    const RobotState state = guard_.state();
    if (state != reported_state_ || sensors_.message != reported_message_) {
      reported_state_ = state;
      reported_message_ = sensors_.message;
      static constexpr const char* kNames[] = {"disarmed", "armed", "damped", "fault", "estopped"};
      const char* name = kNames[static_cast<int>(state)];
      spdlog::info("tick {}: {}{}{}", tick_, name, sensors_.message.empty() ? "" : ": ",
                   sensors_.message);
      node_.SetState(state == RobotState::kFault || state == RobotState::kEstopped
                         ? node::Node::State::kFault
                         : node::Node::State::kActive,
                     sensors_.message.empty() ? name : sensors_.message);
    }
    if (!lockstep_ || (counts_.cycles & 63u) == 0) node_.SetCounts(counts_);
  }

  node::StopFlag& stop_;
  const ProviderOptions& options_;
  GuardConfig guard_config_;
  CommandGuard guard_;
  Plant& plant_;
  bool lockstep_;
  std::uint64_t session_id_ = 0;  // before node_: its raw callbacks read it
  node::Node node_;
  node::Writer<msg::JointState> joint_state_;
  node::Writer<msg::ActuatorState> actuator_state_;
  node::Reader<msg::JointCommand> joint_command_;
  node::Reader<msg::ValveCommand> valve_command_;
  node::Reader<msg::OperatorCommand> operator_command_;
  SimulatedPlant* simulated_;  // the plant, where it is a simulation
  std::optional<node::Reader<msg::SimDisturbance>> disturbance_;
  std::optional<node::Writer<msg::BusStatus>> bus_status_;
  std::optional<node::Writer<msg::FootForce>> foot_force_;
  std::optional<node::Writer<msg::Imu>> imu_;
  std::vector<Awaited> awaited_;
  std::shared_ptr<std::atomic<std::uint64_t>> joint_answered_ =
      std::make_shared<std::atomic<std::uint64_t>>(0);
  std::shared_ptr<std::atomic<std::uint64_t>> valve_answered_ =
      std::make_shared<std::atomic<std::uint64_t>>(0);

  nanoseconds period_{};
  double period_s_ = 0.0;
  std::uint64_t tick_ = 0;
  std::uint64_t last_tick_ = kNever;
  std::int64_t stamp_ns_ = 0;
  WorkTime work_;  // of real-time cycles
  PlantSensors sensors_;
  PlantCommand command_;
  msg::JointState state_;
  msg::ActuatorState actuator_;
  msg::JointCommand accepted_;
  msg::ValveCommand valves_;
  std::uint64_t valve_tick_ = kNever;
  bool holding_ = false;
  std::ptrdiff_t faulty_joints_ = 0;
  std::uint64_t overruns_ = 0;
  node::Node::Counts counts_;
  RobotState reported_state_ = RobotState::kDisarmed;
  std::string reported_message_;
};

}  // namespace

void AddProviderOptions(CLI::App& app, ProviderOptions* options) {
  app.add_option("--rate", options->rate_Hz, "Cycles per second")
      ->check(CLI::Range(1.0, 2000.0))
      ->capture_default_str();
  app.add_option("--duration", options->duration_s,
                 "Length of the session in seconds; 0: until stopped")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--arm", options->arm, "Armed from the first tick (simulation only)");
  app.add_option(
         "--await", options->await,
         "Lockstep: topics whose answer ends a tick, comma-separated; TOPIC:WINDOW lets it lag")
      ->delimiter(',');
  app.add_option("--await-timeout", options->await_timeout_s,
                 "Seconds after which a missing answer is an error")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

GuardConfig LoadGuardConfig(const config::Section& guard) {
  GuardConfig config;
  config.missed_periods = static_cast<int>(guard.IntegerOr("missed_periods", 3, {1, 100}));
  config.fault_after = milliseconds(guard.IntegerOr("fault_after_ms", 60, {1, 10000}));
  config.bridging = guard.ChoiceOr("bridging", "damp", {"damp", "hold"}) == "hold"
                        ? Bridging::kHold
                        : Bridging::kDamp;
  const std::string others =
      guard.ChoiceOr("on_joint_fault", "idle", {"idle", "damp", "hold", "continue"});
  config.on_joint_fault = others == "continue" ? OtherJointsPolicy::kContinue
                          : others == "hold"   ? OtherJointsPolicy::kHold
                          : others == "damp"   ? OtherJointsPolicy::kDamp
                                               : OtherJointsPolicy::kIdle;
  config.damping_Nm_s_rad =
      guard.NumberOr("damping_Nm_s_rad", config.damping_Nm_s_rad, config::kNotNegative);
  return config;
}

void RunProvider(const node::Options& node_options, node::StopFlag& stop,
                 const ProviderOptions& options, const GuardConfig& guard, Plant& plant) {
  GuardConfig effective = guard;
  effective.live = plant.live();
  Provider(node_options, stop, options, effective, plant).Run();
}

}  // namespace sinew::provider
