#include "bridge/joints/watchdog_proof.h"

#include <algorithm>

#include "bridge/joints/faults.h"
#include "components/base/types/angle.h"
#include "components/base/types/text.h"

namespace sinew::bridge {
namespace {

constexpr std::int64_t kFeed_ns = 5'000'000;        // far below any watchdog that is proven here
constexpr std::int64_t kAskAgain_ns = 100'000'000;  // for an axis state
constexpr std::int64_t kEndLimit_ns = 500'000'000;  // for the heartbeat that confirms idle
constexpr std::int64_t kAhead_ns = 20'000'000;      // the last setpoint is planned so far ahead
constexpr std::int64_t kForeign_ns = 250'000'000;   // longer than any period of a bridge
constexpr double kMostHeartbeat_s = 1.5;            // period; slower ones are no witness
constexpr int kMostNamed = 1;                       // joints in a text that must stay short
constexpr int kTrials = 3;                          // whose heartbeat missed its time

using can::AxisState;

class Trial {
 public:
  Trial(const JointConfig& joint, const BridgeTiming& timing, can::Transport& bus,
        const std::function<bool()>& stopped)
      : joint_(joint), timing_(timing), bus_(bus), stopped_(stopped) {}

  WatchdogTrial Run() {
    WatchdogTrial result;
    // Nothing is sent to an axis that somebody else commands. Then idle first of all: what an
    // earlier bridge left behind.
    result.why = Hear();
    if (foreign_) return result;
    Send(can::SetAxisState{AxisState::kIdle});
    for (int k = 0; result.why.empty() && k < kTrials; ++k) {
      result.why = Arm();
      if (!result.why.empty()) break;
      result = Withhold();
      if (result.proven || result.why != kMissed) break;
      if (k + 1 < kTrials) result.why.clear();
    }
    GoIdle();
    if (!result.proven) result.why += "; idled by command";
    return result;
  }

 private:
  static constexpr const char* kMissed =
      "its heartbeats or this program are not on time: the time to idle cannot be measured";

  template <class Message>
  void Send(const Message& message) {
    sent_ns_ = bus_.now_ns();
    (void)bus_.Send(can::Encode(joint_.node, message, joint_.firmware));
  }
  void Feed() { Send(can::SetInputTorque{0.0}); }

  // True: a heartbeat came. Until then at most.
  bool Listen(std::int64_t until_ns) {
    can::Received received;
    while (!stopped_()) {
      const std::int64_t left_ns = until_ns - bus_.now_ns();
      if (!bus_.Receive(std::chrono::nanoseconds(std::max<std::int64_t>(left_ns, 0)), &received)) {
        if (left_ns <= 0) return false;
        continue;
      }
      if (Take(received)) return true;
    }
    return false;
  }

  bool Take(const can::Received& received) {
    const auto address = can::AddressOf(received.frame);
    if (!address || address->node != joint_.node) return false;
    if (can::IsOfMaster(address->command)) {
      foreign_ = true;
      return false;
    }
    const auto heartbeat = can::Decode<can::Heartbeat>(received.frame, joint_.firmware);
    if (!heartbeat) return false;
    period_ns_ = heartbeat_ns_ == 0 ? 0 : received.stamp_ns - heartbeat_ns_;
    heartbeat_ns_ = received.stamp_ns;
    heartbeat_ = *heartbeat;
    heartbeat_.axis_error = can::ErrorsOf(*heartbeat);
    return true;
  }

  // Heartbeats, their period, and nobody else who sends setpoints.
  std::string Hear() {
    const std::int64_t begin_ns = bus_.now_ns();
    const std::int64_t give_up_ns = begin_ns + ToNs(timing_.start_timeout_s);
    while (period_ns_ == 0 || bus_.now_ns() < begin_ns + kForeign_ns) {
      if (stopped_()) return "stopped";
      if (bus_.now_ns() >= give_up_ns) return "no heartbeats of axis node " + Node();
      (void)Listen(std::min(give_up_ns, bus_.now_ns() + kForeign_ns));
      if (foreign_) return "another program sends to axis node " + Node();
    }
    if (static_cast<double>(period_ns_) > 1e9 * kMostHeartbeat_s) {
      return "its heartbeats come too seldom";
    }
    return "";
  }

  // Fed all the while, until a heartbeat that is newer than the request fulfils the condition.
  template <class Ask, class Condition>
  bool Until(double limit_s, Ask ask, Condition condition) {
    const std::int64_t begin_ns = bus_.now_ns();
    std::int64_t ask_ns = begin_ns;
    while (!stopped_() && bus_.now_ns() < begin_ns + ToNs(limit_s)) {
      if (bus_.now_ns() >= ask_ns) {
        ask();
        ask_ns = bus_.now_ns() + kAskAgain_ns;
      }
      Feed();
      if (Listen(bus_.now_ns() + kFeed_ns) && heartbeat_ns_ > begin_ns && condition()) return true;
    }
    return false;
  }

  std::string Arm() {
    const auto calm = [this] {
      return heartbeat_.axis_error == 0 && heartbeat_.axis_state == AxisState::kIdle;
    };
    const auto clear = [this] {
      Send(can::SetAxisState{AxisState::kIdle});
      Send(can::ClearErrors{});
    };
    if (!Until(timing_.closed_loop_timeout_s, clear, calm)) {
      return stopped_() ? "stopped" : "it does not become idle without an error" + State();
    }
    const auto request = [this] {
      Send(can::SetControllerMode{can::ControlMode::kTorque, can::InputMode::kPassthrough});
      Feed();
      Send(can::SetLimits{joint_.limits.velocity_rad_s * joint_.gear_ratio / types::kTwoPi,
                          joint_.limits.current_A});
      Send(can::SetAxisState{AxisState::kClosedLoopControl});
    };
    const auto closed_loop = [this] { return InClosedLoop(); };
    if (!Until(timing_.closed_loop_timeout_s, request, closed_loop)) {
      return stopped_() ? "stopped" : "it does not enter closed-loop control" + State();
    }
    return "";
  }

  WatchdogTrial Withhold() {
    const std::int64_t window_ns = ToNs(kWatchdogLimit_s + 0.5 * kWatchdogResolution_s);
    const std::int64_t most_ns = ToNs(kWatchdogLimit_s + kWatchdogResolution_s);
    std::int64_t last_ns = heartbeat_ns_ - window_ns;
    while (last_ns < bus_.now_ns() + kAhead_ns) last_ns += period_ns_;
    while (!stopped_() && bus_.now_ns() < last_ns - kFeed_ns / 2) {
      Feed();
      (void)Listen(std::min(bus_.now_ns() + kFeed_ns, last_ns));
    }
    while (!stopped_() && bus_.now_ns() < last_ns) (void)Listen(last_ns);
    Feed();
    const std::int64_t from_ns = sent_ns_;

    WatchdogTrial result;
    if (!InClosedLoop() || from_ns > last_ns + ToNs(kWatchdogResolution_s)) {
      result.why = kMissed;  // this process was kept from its times
      return result;
    }
    const std::int64_t give_up_ns = from_ns + most_ns + period_ns_ + ToNs(kWatchdogResolution_s);
    while (Listen(give_up_ns)) {
      if (heartbeat_ns_ <= from_ns) continue;
      const double after_ms = 1e-6 * static_cast<double>(heartbeat_ns_ - from_ns);
      if (InClosedLoop()) {
        result.runs_after_ms = after_ms;
        if (heartbeat_ns_ - from_ns < ToNs(kWatchdogLimit_s)) continue;
        break;
      }
      result.idle_after_ms = after_ms;
      break;
    }
    const bool expired = (heartbeat_.axis_error & can::axis_error::kWatchdogTimerExpired) != 0;
    if (stopped_()) {
      result.why = "stopped";
    } else if (foreign_) {
      result.why = "another program sends to axis node " + Node();
    } else if (result.idle_after_ms == 0.0) {
      result.why = types::Text(
          "its watchdog does not fire: in closed-loop control %.0f ms after the last "
          "setpoint, at most %.0f ms are allowed",
          result.runs_after_ms, 1e3 * kWatchdogLimit_s);
      result.refuted = true;
    } else if (!expired) {
      result.why = "it became idle for another reason than its watchdog" + State();
    } else if (result.idle_after_ms > 1e-6 * static_cast<double>(most_ns)) {
      result.why = kMissed;
    } else {
      result.proven = true;
    }
    return result;
  }

  void GoIdle() {
    Send(can::SetAxisState{AxisState::kIdle});
    const std::int64_t begin_ns = bus_.now_ns();
    can::Received received;
    while (bus_.now_ns() < begin_ns + kEndLimit_ns) {  // without `stopped`: the end of all
      if (!bus_.Receive(std::chrono::nanoseconds(kFeed_ns), &received) || !Take(received)) continue;
      if (heartbeat_ns_ > begin_ns && !InClosedLoop()) break;
      Send(can::SetAxisState{AxisState::kIdle});
    }
    Send(can::ClearErrors{});
  }

  bool InClosedLoop() const { return heartbeat_.axis_state == AxisState::kClosedLoopControl; }
  std::string Node() const { return std::to_string(joint_.node); }
  std::string State() const {
    return heartbeat_.axis_error != 0 ? ": " + AxisErrorText(heartbeat_.axis_error) : "";
  }

  const JointConfig& joint_;
  const BridgeTiming& timing_;
  can::Transport& bus_;
  const std::function<bool()>& stopped_;
  can::Heartbeat heartbeat_;
  std::int64_t heartbeat_ns_ = 0, period_ns_ = 0, sent_ns_ = 0;
  bool foreign_ = false;
};

}  // namespace

WatchdogTrial TryWatchdog(const JointConfig& joint, const BridgeTiming& timing, can::Transport& bus,
                          const std::function<bool()>& stopped) {
  return Trial(joint, timing, bus, stopped).Run();
}

bool SameAxis(const WatchdogProof& proof, const JointConfig& joint) {
  return proof.serial_number == joint.serial_number && proof.node == joint.node;
}

bool Proves(const WatchdogProof& proof, const JointConfig& joint) {
  return !joint.serial_number.empty() && SameAxis(proof, joint) &&
         proof.firmware == joint.firmware && proof.idle_after_ms > 0.0 &&
         proof.idle_after_ms <= 1e3 * (kWatchdogLimit_s + kWatchdogResolution_s);
}

std::string MissingProofs(const std::vector<JointConfig>& joints,
                          const std::vector<WatchdogProof>& proofs, const std::string& command) {
  std::string who;
  int missing = 0;
  for (const JointConfig& joint : joints) {
    const bool proven = std::any_of(proofs.begin(), proofs.end(), [&](const WatchdogProof& proof) {
      return Proves(proof, joint);
    });
    if (proven || ++missing > kMostNamed) continue;
    who += (who.empty() ? "joint '" : ", joint '") + joint.name + "' (axis node " +
           std::to_string(joint.node) +
           (joint.serial_number.empty() ? ", no serial_number in the joint map)"
                                        : ", serial number " + joint.serial_number + ")");
  }
  if (missing == 0) return "";
  if (missing > kMostNamed) who += " and " + std::to_string(missing - kMostNamed) + " more";
  return "no proof that the watchdog works of " + who + "; make it with: " + command;
}

}  // namespace sinew::bridge
