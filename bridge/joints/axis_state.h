// Arming of one joint: a state machine of commanded mode, heartbeat and faults, that decides what
// is requested of the axis and whether it gets its command or a neutral setpoint.
//
//     idle --command--> arming --heartbeat in closed loop--> active
//       ^                  |                                    |
//       +---- command idle, fault, reset, end ------------------+
//
// Arming: mode, limits and closed-loop control are requested, again every 100 ms, until a heartbeat
// that is newer than the first request reports closed loop. No heartbeat says the mode, and a frame
// may be lost: it is sent again every 100 ms to an active axis. Idle is requested in every cycle
// until a heartbeat that is newer than the first request reports it. kNoClosedLoop: it does not
// come within the time limit, or an active axis leaves closed loop without an error. A joint whose
// zero check fails is not armed (kZero).
//
// Pure: no transport, no clock. One thread; allocates only for the text of a fault.
#pragma once

#include <cstdint>

#include "bridge/joints/faults.h"
#include "bridge/joints/joint_measurement.h"
#include "components/base/types/control_mode.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {

enum class AxisPhase { kIdle, kArming, kActive };

enum class AxisRequest {
  kNone,
  kIdle,        // axis state idle
  kClosedLoop,  // mode, limits, axis state closed-loop control
  kMode,        // mode of an axis in closed loop: neutral setpoint of that mode first
  kModeAgain,   // the mode that it should be in; its setpoint follows
};

struct AxisDecision {
  AxisRequest request = AxisRequest::kNone;
  bool follows_command = false;   // else a neutral setpoint
  bool restart_setpoint = false;  // position setpoints begin at the measured position
};

enum class ErrorAction { kNone, kClear, kRequestCodes };

class AxisStateMachine {
 public:
  explicit AxisStateMachine(std::int64_t closed_loop_timeout_ns = 0)
      : closed_loop_timeout_ns_(closed_loop_timeout_ns) {}

  // One control cycle; a joint with a fault is commanded idle.
  AxisDecision Step(types::ControlMode command, const JointMeasurement& measured,
                    std::int64_t now_ns, FaultLatch* fault);
  // Idle at once, requested by the caller. The joint moves again only after arming.
  void GoIdle(std::int64_t now_ns);

  // The action for the axis error of the last heartbeat. kClear: the watchdog of an axis that is
  // not active expired, as between the start and the first cycle; it is no fault, and `measured` is
  // cleared, too. kRequestCodes: once for each error.
  ErrorAction AssessErrors(std::int64_t now_ns, const FaultLatch& fault,
                           JointMeasurement* measured);
  // The operator's reset: error codes are requested again for the next error.
  void ForgetErrors() { codes_requested_ = false; }

  AxisPhase phase() const { return phase_; }
  // The mode that the axis is in or arms for; kIdle in the idle phase.
  types::ControlMode mode() const {
    return phase_ == AxisPhase::kIdle ? types::ControlMode::kIdle : mode_;
  }

 private:
  AxisDecision StepArming(types::ControlMode command, bool confirmed, std::int64_t turn_ns,
                          std::int64_t now_ns, FaultLatch* fault);
  void Enter(AxisPhase phase, std::int64_t now_ns);
  bool RequestIsOld(std::int64_t now_ns) const;
  AxisRequest Request(AxisRequest request, std::int64_t now_ns);

  std::int64_t closed_loop_timeout_ns_;
  AxisPhase phase_ = AxisPhase::kIdle;
  types::ControlMode mode_ = types::ControlMode::kIdle;
  std::int64_t phase_ns_ = 0;      // begin of the phase
  std::int64_t requested_ns_ = 0;  // last request of closed loop or of a mode
  bool codes_requested_ = false;
};

// The controller takes Clear_Errors within this time.
inline constexpr std::int64_t kClearing_ns = 5'000'000;

// Whole turns of the motor by which the controller's count is off, by the output encoder. Certain
// while half the play and the tolerance are less than half a motor turn. Needs an output node.
double WholeTurnsOff(const JointMeasurement& measured);

// A fault where the two encoders of the output angle disagree by more than half the play and the
// tolerance; nothing where there is no check.
void AssessZero(const JointMeasurement& measured, FaultLatch* fault);

}  // namespace sinew::bridge
