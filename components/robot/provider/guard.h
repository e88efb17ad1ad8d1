// Permission to move the robot: the state provider's check of arming and of each command's age.
//
// Pure and deterministic: time is the provider's own tick and its own clock. A command is as old as
// the distance between the provider's tick and the tick it echoes, and for hardware at least as old
// as that tick by the clock, so that a provider that stalled does not take an old command for a
// fresh one; foreign clocks never matter. When missed_periods have passed without their commands
// the guard damps or holds (unlatched: a fresh command ends it), after fault_after it latches a
// fault. Everything starts disarmed; a fault or an estop ends only by Reset, and then by Arm. A
// joint's own fault idles that joint; what the other joints do is configured (OtherJointsPolicy).
// A fall latches a fault, in which the joints idle or are damped (FallPolicy).
// Thread: one. Allocates nothing.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "components/base/types/fault.h"
#include "components/base/types/message_header.h"
#include "components/base/types/robot_state.h"
#include "components/robot/provider/plant.h"

namespace sinew::provider {

enum class Bridging { kDamp, kHold };
// Policy for the other joints when one has a fault of its own. All but kContinue latch the robot's
// fault: no command counts until Reset and Arm. Damping and holding end by Disarm, Estop or Reset.
enum class OtherJointsPolicy { kIdle, kDamp, kHold, kContinue };

// Policy for the joints of a robot that falls, until Disarm, Estop or Reset.
enum class FallPolicy { kIdle, kDamp };
struct FallGuardConfig;  // fall_guard.h

// Relays of a robot in FAULT or ESTOPPED: all off, which keeps the pressure, or its air let out.
enum class ValvesInFault { kHold, kVent };

// As a fault's value and limit have it.
constexpr double Milliseconds(std::chrono::nanoseconds time) {
  return 1e-6 * static_cast<double>(time.count());
}

struct GuardConfig {
  int missed_periods = 3;                     // without their commands: bridge the gap
  std::chrono::milliseconds fault_after{60};  // older than this: latched fault
  Bridging bridging = Bridging::kDamp;
  double damping_Nm_s_rad = 2e-5;  // motor side, per motor rad/s
  OtherJointsPolicy on_joint_fault = OtherJointsPolicy::kIdle;
  ValvesInFault valves_in_fault = ValvesInFault::kHold;
  bool live = false;  // hardware: only live commands count
  FallPolicy on_fall = FallPolicy::kIdle;
  std::shared_ptr<const FallGuardConfig> fall;  // null: nobody looks for falls
};

enum class Verdict {
  kPass,  // the last accepted command is fresh: use it
  kIdle,  // motors off
  kDamp,
  kHold,
};

class CommandGuard {
 public:
  // Throws std::invalid_argument for limits that are not positive.
  explicit CommandGuard(const GuardConfig& config);

  void StartSession(std::uint64_t session_id);

  // arm is bound to a session: false (and nothing changes) for another one, or after a fault or
  // estop.
  bool Arm(std::uint64_t session_id, std::uint64_t tick);
  void Disarm();
  void Estop();
  void Fail(const types::Fault& fault);        // all joints idle
  void JointFault(const types::Fault& fault);  // the others follow the OtherJointsPolicy
  void Fall();                                 // of the robot: its joints follow the FallPolicy
  bool Reset();                                // from fault or estop to disarmed

  // True when the command counts: own session, allowed origin, not from the future, newer than the
  // last. Its stamp is not read.
  bool Offer(const types::MessageHeader& header, std::uint64_t tick);

  // The gap is being bridged: this period's command is waited for no longer.
  bool Overdue(std::uint64_t tick) const;

  // Once a cycle, after Offer. `age`: by the clock, since the tick of the newest accepted command
  // (last_tick) began; 0 where time is simulated. A command is used in its own period, which is
  // therefore subtracted.
  Verdict Step(std::uint64_t tick, std::chrono::nanoseconds period,
               std::chrono::nanoseconds age = std::chrono::nanoseconds(0));
  std::uint64_t last_tick() const { return last_tick_; }  // accepted, or of arming

  types::RobotState state() const { return state_; }
  const types::Fault& fault() const { return fault_; }  // the first since the last Reset
  std::uint64_t refused() const { return refused_; }
  std::uint64_t faults() const { return faults_; }

 private:
  GuardConfig config_;
  types::RobotState state_ = types::RobotState::kDisarmed;
  types::Fault fault_;
  std::uint64_t session_id_ = 0;
  std::uint64_t last_tick_ = 0;        // of the last accepted command, or of arming
  bool has_command_ = false;           // since arming
  Verdict in_fault_ = Verdict::kIdle;  // what the joints do although the robot has a fault
  std::uint64_t refused_ = 0, faults_ = 0;
};

}  // namespace sinew::provider
