#include "bench/signals/bus_watch.h"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "bridge/can/codec.h"
#include "components/base/types/clock/clock.h"

namespace sinew::signals {
namespace {

constexpr int kNode = 3;
constexpr can::Firmware kFirmware = can::Firmware::k0_5_6;  // robots/rig/can_bridge.yaml
// The controller's torque constant over the motor's, ibid.
constexpr double kScale = 0.0137833 / 0.0159155;
constexpr std::size_t kTicks = 1200;  // 5 s at 240 Hz
constexpr std::int64_t kSettled_ns = 300'000'000;
constexpr std::size_t kWitnessWindows = 4000;

// The newest command is executed for three missed periods (guard), and answers a state that is a
// period old at most: 4 x 4.17 + 4.17 ms.
constexpr double kOldest_ms = 20.8;
// A provider that lives requests idle after 64.2 ms; of one that does not, the axis' own watchdog
// (100 ms); and its heartbeat comes every 100 ms.
constexpr double kLongestWithout_ms = 64.2 + 100.0 + 100.0;

constexpr int kPriority =
    45;  // below the bus, above whom it watches (components/topics/node/realtime.cc)

double Milliseconds(std::int64_t ns) { return 1e-6 * static_cast<double>(ns); }

}  // namespace

void BecomeWatcher() {
  const sched_param parameters{.sched_priority = kPriority};
  (void)::sched_setscheduler(0, SCHED_FIFO, &parameters);
}

void StartOrdinaryProcesses() {
  sched_param parameters{};
  const int policy = ::sched_getscheduler(0);
  if (policy < 0 || ::sched_getparam(0, &parameters) != 0) return;
  (void)::sched_setscheduler(0, policy | SCHED_RESET_ON_FORK, &parameters);
}

void Published::Add(const msg::JointState& state, std::int64_t now_ns) {
  const Tick tick{state.header.session_id, state.header.tick};
  const std::int64_t epoch_ns = types::EpochNow_ns();
  measured_ns_[tick] = now_ns - std::max<std::int64_t>(0, epoch_ns - state.header.stamp_ns);
  states_.push_back(tick);
  if (state.robot_state == msg::RobotState::kArmed) armed_ns_.push_back(measured_ns_[tick]);
  while (armed_ns_.size() > kTicks) armed_ns_.pop_front();
  while (states_.size() > kTicks) {
    measured_ns_.erase(states_.front());
    states_.pop_front();
  }
}

void Published::Add(const msg::JointCommand& command) {
  const Tick tick{command.header.session_id, command.header.tick};
  const bool torque = command.mode[0] == msg::CommandMode::kTorque;  // else idle: none
  const auto value = torque ? static_cast<float>(command.motor_torque_Nm[0] * kScale) : 0.0F;
  newest_[value] = tick;
  commands_.emplace_back(value, tick);
  while (commands_.size() > kTicks) {
    const auto [old, of] = commands_.front();
    commands_.pop_front();
    const auto known = newest_.find(old);
    if (known != newest_.end() && known->second == of) newest_.erase(known);
  }
}

std::int64_t Published::MeasuredAt_ns(float torque_Nm) const {
  const float near_Nm = 4.0F * std::numeric_limits<float>::epsilon() * std::abs(torque_Nm);
  std::int64_t newest_ns = 0;
  const auto end = newest_.upper_bound(torque_Nm + near_Nm);
  for (auto one = newest_.lower_bound(torque_Nm - near_Nm); one != end; ++one) {
    const auto measured = measured_ns_.find(one->second);
    if (measured != measured_ns_.end()) newest_ns = std::max(newest_ns, measured->second);
  }
  return newest_ns;
}

std::int64_t Published::ArmedUntil_ns(std::int64_t at_ns) const {
  const auto later = std::upper_bound(armed_ns_.begin(), armed_ns_.end(), at_ns);
  return later == armed_ns_.begin() ? 0 : *std::prev(later);
}

BusWatch::BusWatch(const std::string& bus) : bus_({.bus = bus}) {
  thread_ = std::thread([this] { Receive(); });
}

BusWatch::~BusWatch() {
  stop_ = true;
  thread_.join();
}

void BusWatch::Receive() {
  BecomeWatcher();
  can::Received received;
  while (!stop_) {
    if (!bus_.Receive(std::chrono::milliseconds(20), &received)) continue;
    const auto address = can::AddressOf(received.frame);
    if (!address || address->node != kNode) continue;
    const auto setpoint = can::Decode<can::SetInputTorque>(received.frame, kFirmware);
    const auto heartbeat = can::Decode<can::Heartbeat>(received.frame, kFirmware);
    const std::lock_guard lock(mutex_);
    if (address->command == can::Command::kSetInputTorque && setpoint) {
      frames_.push_back({received.stamp_ns, false, false, static_cast<float>(setpoint->torque_Nm)});
    } else if (heartbeat) {
      const bool closed_loop = heartbeat->axis_state == can::AxisState::kClosedLoopControl;
      frames_.push_back({received.stamp_ns, true, closed_loop, 0.0F});
    }
  }
}

void BusWatch::Assess(const Published& published, std::int64_t now_ns) {
  const double late_ms = witness_.Take_ms();
  late_ms_.emplace_back(now_ns, late_ms);
  if (late_ms > 1.0) ++findings_.late_windows;
  ++findings_.windows;
  while (late_ms_.size() > kWitnessWindows) late_ms_.pop_front();
  while (true) {
    Frame frame{};
    {
      const std::lock_guard lock(mutex_);
      if (frames_.empty() || frames_.front().stamp_ns > now_ns - kSettled_ns) return;
      frame = frames_.front();
      frames_.pop_front();
    }
    frame.heartbeat ? AssessHeartbeat(frame, published) : AssessSetpoint(frame, published);
  }
}

void BusWatch::AssessSetpoint(const Frame& frame, const Published& published) {
  ++findings_.setpoints;
  const std::int64_t measured_ns = published.MeasuredAt_ns(frame.torque_Nm);
  if (measured_ns == 0 || measured_ns > frame.stamp_ns) return;  // damping, or a value of later
  const double age_ms =
      Milliseconds(frame.stamp_ns - measured_ns) - Late_ms(measured_ns, frame.stamp_ns);
  // Without torque: of a command if there is one, else of the guard. It moves nothing.
  if (frame.torque_Nm == 0.0F && age_ms > kOldest_ms) return;
  ++findings_.matched;
  findings_.oldest_ms = std::max(findings_.oldest_ms, age_ms);
  if (age_ms > kOldest_ms) {
    Violate(frame, "executed " + std::to_string(1e3 * frame.torque_Nm) +
                       " mN m, commanded on a state that was measured " + std::to_string(age_ms) +
                       " ms before");
  }
  if (measured_ns <= measured_ns_) return;  // the same once more
  measured_ns_ = measured_ns;
  command_ns_ = frame.stamp_ns;
}

void BusWatch::AssessHeartbeat(const Frame& frame, const Published& published) {
  if (frame.closed_loop && !closed_loop_) closed_since_ns_ = frame.stamp_ns;
  closed_loop_ = frame.closed_loop;
  if (!closed_loop_) return;
  // Of two writers the provider may hear one while DDS lets us hear the other, which is stopped:
  // then the provider's word stands for the commands.
  const std::int64_t since_ns =
      std::max({closed_since_ns_, command_ns_, published.ArmedUntil_ns(frame.stamp_ns)});
  const double without_ms =
      Milliseconds(frame.stamp_ns - since_ns) - Late_ms(since_ns, frame.stamp_ns);
  findings_.longest_without_ms = std::max(findings_.longest_without_ms, without_ms);
  if (without_ms > kLongestWithout_ms) {
    Violate(frame, "in closed loop without a command for " + std::to_string(without_ms) + " ms");
  }
}

double BusWatch::WithoutCommand_ms(std::int64_t now_ns) const {
  return Milliseconds(now_ns - command_ns_);
}

double BusWatch::Late_ms(std::int64_t from_ns, std::int64_t to_ns) const {
  double latest_ms = 0.0;
  for (const auto& [read_ns, late_ms] : late_ms_) {
    const bool within = read_ns >= from_ns && read_ns <= to_ns + kSettled_ns;
    if (within && late_ms > 1.0) latest_ms = std::max(latest_ms, late_ms);
  }
  return latest_ms;
}

void BusWatch::Violate(const Frame& frame, const std::string& what) {
  char stamp[32];
  std::snprintf(stamp, sizeof stamp, "%.3f s: ", 1e-9 * static_cast<double>(frame.stamp_ns));
  findings_.violations.push_back(stamp + what);
}

}  // namespace sinew::signals
