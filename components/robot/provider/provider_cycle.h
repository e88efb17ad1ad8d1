// The decisions of a state provider, cycle by cycle: who may move the robot, which command the
// plant gets, what the messages of the cycle say of it. No DDS, no clock, no plant: time (the
// tick), decoded messages and sensor readings come in, decisions go out.
// participant/run_provider.cc joins it to topics, timer and plant.
//
// One cycle, tick k:
//
//   Take(operator)    any number of times, also between the following
//   Begin             when the tick begins, by the clock
//   Header            of the messages that are published, with state() and last()
//   Take(joint, valve)   commands that arrive until the cycle's end
//   Command           the plant's command from k to k + 1, from the newest accepted messages
//   Observe           sensors at k + 1: a fault of the plant or of joints changes the state
//   ObserveBody       where GuardConfig::fall is given: a fall does (fall_guard.h)
//
// Rules: CommandGuard (guard.h) says whether joint commands pass, or joints idle, damp or hold. A
// joint with a fault of its own idles. A command with a value that is not finite is a fault of the
// robot: all joints idle in that very cycle, and no part of it reaches the plant. Nor does a
// reading of the sensors that is not finite: such a joint idles instead of holding and is damped
// without torque. Relays follow the newest valve command while it is at most fault_after old, else
// they are off; in FAULT and ESTOPPED they are as GuardConfig::valves_in_fault declares.
//
// Units: SI, as plant.h. Thread: one. Nothing allocates after construction.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "components/base/types/command_rule.h"
#include "components/base/types/control_mode.h"
#include "components/base/types/fault.h"
#include "components/base/types/joints.h"
#include "components/base/types/message_header.h"
#include "components/base/types/operator_action.h"
#include "components/base/types/robot_state.h"
#include "components/robot/provider/fall_guard.h"
#include "components/robot/provider/guard.h"
#include "components/robot/provider/plant.h"

namespace sinew::provider {

// A joint_command, decoded: mode and setpoints of each joint. Entries from joint_count on idle.
struct JointSetpoints {
  types::MessageHeader header{.origin = types::Origin::kSim};
  int joint_count = 0;
  types::JointArray<types::ControlMode> mode{};
  types::JointArray<double> motor_torque_Nm{};
  types::JointArray<double> position_rad{};
  types::JointArray<double> velocity_rad_s{};
  // The first joint that the command's controller names otherwise than the robot.
  std::optional<int> other_joint;
};

// A valve_command, decoded. Entries from joint_count on are off.
struct ValveCommand {
  types::MessageHeader header{.origin = types::Origin::kSim};
  int joint_count = 0;
  types::JointArray<bool> valve_open{};
  types::JointArray<bool> compressor_on{};
  types::JointArray<bool> vent_open{};
};

struct OperatorCommand {
  std::uint64_t session_id = 0;
  types::Origin origin = types::Origin::kSim;
  types::OperatorAction action = types::OperatorAction::kStop;
};

enum class OperatorResult {
  kDone,
  kClearFaults,          // a reset: the plant's faults are to be cleared before its next step
  kUnlatchFirst,         // a reset: the latch on disk goes first, then FinishReset
  kRefusedOtherSession,  // arm or reset: meant for another session
  kRefusedOrigin,        // arm or reset: replayed, or for hardware not from a live operator
  kRefusedByPlant,       // arm: Plant::ArmRefusal says why
  kRefusedByFallGuard,   // arm: ProviderCycle::FallRefusal says why
  kRefusedByCommand,     // arm: ProviderCycle::CommandFault says why
  kRefusedByEstop,       // arm: an estop that the robot requires is not watched, or held
  kRefusedUnanswered,    // arm: no controller answers, CycleConfig::arm_needs_answers
  kRefusedResetFirst,    // arm: after a fault or an estop
  kRefusedDisarmFirst,   // reset: a joint that had a fault would move at once
  kNotForProvider,       // start, stop, handover and permissions are for others
};

enum class FaultChange {
  kNone,
  kJoint,  // one more joint has a fault of its own; the plant's message says why
  kRobot,  // the plant has a fault, or all joints have
};

struct CycleConfig {
  GuardConfig guard;  // guard.live: the plant is hardware
  std::uint64_t session_id = 0;
  int joint_count = 1;
  double rate_Hz = 240.0;
  double duration_s = 0.0;      // 0: no end
  bool simulated_time = false;  // stamps: tick / rate instead of the time given
  // Hardware moves on while its provider stalls: commands age by the clock too, and a cycle that
  // begins more than guard.fault_after after the one before is a fault of a robot that may move.
  bool ages_by_clock = false;
  bool plant_may_be_armed = true;
  bool estop_is_latched = false;  // on disk: a reset from ESTOPPED is done in two steps
  // Arming needs a joint command under the session id that is at most guard.fault_after old, since
  // it would end in a fault without. A simulation may be armed alone.
  bool arm_needs_answers = false;
};

// The session id of a seed (splitmix64): spreads small seeds over 64 bits; never 0.
std::uint64_t SessionFromSeed(std::uint64_t seed) noexcept;

class ProviderCycle {
 public:
  // Throws std::invalid_argument: joint_count outside 1 to types::kMaxJoints, a rate that is not
  // positive, or what CommandGuard and FallGuard refuse; a fall guard of another number of joints.
  explicit ProviderCycle(const CycleConfig& config);

  // Without an operator, and before a fall detector can have started. False: not yet, by
  // arm_needs_answers.
  bool ArmAtStart(std::uint64_t tick = 0);

  // disarm and estop count from any sender; arm and reset only with the cycle's own session_id,
  // and not from a recording.
  OperatorResult Take(const OperatorCommand& command, std::uint64_t tick);
  // Every estop that the robot requires is watched and none is held (estop/watch.h); without this
  // nobody arms. True until it is said otherwise.
  void SetEstopsWatched(bool watched) { estops_watched_ = watched; }
  // After kUnlatchFirst, when nothing on disk latches the estop any more: the reset itself. Does
  // nothing in another state than ESTOPPED. True: the plant's faults are to be cleared.
  bool FinishReset();
  // True: the command counts and is the newest.
  bool Take(const JointSetpoints& command, std::uint64_t tick);
  // The same; not newer than the last one that counted: dropped.
  bool Take(const ValveCommand& command, std::uint64_t tick);

  // Once a cycle, first; of a clock that only goes forward, as Command's. True: it begins too long
  // after the last one, which is a fault now.
  bool Begin(std::uint64_t tick, std::int64_t now_ns);
  // now_ns: UTC; not read with simulated_time.
  types::MessageHeader Header(std::uint64_t tick, std::int64_t now_ns) const;
  // Once a cycle, and again in one in which an estop came after it. The reference is valid until
  // the next call. now_ns: read with ages_by_clock only.
  const PlantCommand& Command(std::uint64_t tick, const PlantSensors& sensors,
                              std::int64_t now_ns = 0);
  FaultChange Observe(const PlantSensors& sensors);
  // After Observe, where falls() are looked for. kRobot: a fall was found; it is a fault now.
  FaultChange ObserveBody(std::uint64_t tick, const PlantSensors& sensors, const BodySensors& body);
  bool falls() const { return fall_.has_value(); }
  bool upright() const { return fall_ && fall_->upright(); }
  // The fall that was found, until the operator's reset; empty: none.
  std::string_view fall_message() const { return fall_ ? fall_->message() : std::string_view(); }
  // Why the fall detector lets nobody arm; empty: it does. Allocates.
  std::string FallRefusal() const { return fall_ ? fall_->ArmRefusal() : std::string(); }

  // The fault that keeps the newest joint command under the present session id from being obeyed.
  const types::Fault& CommandFault() const { return command_fault_; }

  // Real time: the joint command of this tick is waited for. False: nobody may move, or the
  // command has arrived.
  bool AwaitsCommand(std::uint64_t tick) const;
  // The gap is being bridged: this period's command is not waited for.
  bool Overdue(std::uint64_t tick) const { return guard_.Overdue(tick); }

  types::RobotState state() const { return guard_.state(); }
  const types::Fault& fault() const { return guard_.fault(); }
  std::uint64_t refused() const { return guard_.refused(); }
  bool last(std::uint64_t tick) const { return tick == last_tick_; }
  // One more than the newest tick under the present session id that was answered, whether the
  // answer was accepted or not; 0: none.
  std::uint64_t joint_answers() const { return joint_answers_; }
  std::uint64_t valve_answers() const { return valve_answers_; }
  std::uint64_t session_id() const { return config_.session_id; }
  types::RunningSession running() const {
    return {config_.session_id, config_.guard.live ? types::Origin::kLive : types::Origin::kSim};
  }
  // The rule of components/base/types/command_rule.h for a request to this provider.
  bool Admits(const types::MessageHeader& header) const {
    return types::RefusalOf(types::CommandKind::kRequest, header, running()) ==
           types::CommandRefusal::kNone;
  }
  std::chrono::nanoseconds period() const { return period_; }
  double period_s() const { return period_s_; }
  std::chrono::nanoseconds fault_after() const { return config_.guard.fault_after; }

 private:
  // That a command is for other joints than the robot's.
  types::Fault FaultOf(const JointSetpoints& command) const;
  // False: arming waits for a controller.
  bool AnsweredForArming(std::uint64_t tick) const;
  // Joint j of command_ as the accepted joint command says.
  void Pass(std::size_t joint);
  // The first joint whose part of the accepted joint command is not finite.
  std::optional<std::size_t> NotFinite() const;
  bool ValvesFollow(std::uint64_t tick) const;
  std::chrono::nanoseconds AgeByClock(std::uint64_t tick, std::int64_t now_ns) const;

  static constexpr std::uint64_t kTicksKept = 1024;  // older than any command that counts

  void ResetFaults();  // of joints and falls, by the operator

  CycleConfig config_;
  CommandGuard guard_;
  std::optional<FallGuard> fall_;
  bool estops_watched_ = true;
  bool asks_ = false;                                // command_ is a controller's or a hold
  std::array<std::int64_t, kTicksKept> began_ns_{};  // of tick k at k % kTicksKept; ages_by_clock
  std::chrono::nanoseconds period_{};
  double period_s_ = 0.0;
  std::optional<std::uint64_t> last_tick_;
  JointSetpoints joints_;               // the last accepted
  std::optional<ValveCommand> valves_;  // the last accepted
  PlantCommand command_;
  bool holding_ = false;            // the positions to hold were taken in an earlier cycle
  types::JointArray<bool> held_{};  // those that were known
  std::ptrdiff_t faulty_joints_ = 0;
  std::uint64_t joint_answers_ = 0, valve_answers_ = 0;
  types::Fault command_fault_;
};

}  // namespace sinew::provider
