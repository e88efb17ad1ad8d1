// Control of one joint: what it should be at, PID and feed-forward, limits, safe commands.
//
// What it follows, in this order: the reference; else a motion order; else it holds. Whenever that
// changes (arming included) it goes on from where it is: the difference to the new target fades out
// over takeover_s (quintic; replay_takeover_s where a recording begins to move live hardware), and
// a jump of the feed-forward fades out with the time constant crossfade_s. Where a feed-forward
// begins, the integral gives up what it held in its place.
//
// Command, torque strategies: limit(PID / (N efficiency) + feed-forward) at the motor shaft; the
// cut part goes back into the integral. kPosition gives the target to the drive's own loops.
// kComputedTorque: PD and the torque prediction (thesis Fig. 7.6), without an integral: what the
// motion needs is the prediction's part. So it counts while the joint holds, too, where kPidEsn has
// its integral; an idle reference names the measured positions, at rest.
//
// Late input: until it is stale_grace_s old the reference goes on at its last acceleration, and the
// last prediction and the last regime stay; one that comes a tick late every time is as good.
// Older, it is lost: without a reference the target stays where it was, at rest, or there is only
// damping (on_stale); without prediction or regime there is no network. A lost position leaves
// damping by motor velocity, or no torque. All of it is marked stale. Non-finite input, or a
// tracking error above its limit, latches a fault: motor off until disarmed.
//
// Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <algorithm>
#include <optional>

#include "components/base/types/regime.h"
#include "components/model/actuator/model.h"
#include "components/robot/control/compensator.h"
#include "components/robot/control/pid.h"
#include "components/robot/control/types.h"
#include "components/robot/reference/trajectory.h"

namespace sinew::control {

enum class Strategy { kPosition, kPid, kPidLinear, kPidEsn, kComputedTorque };

// The command has the torque prediction in it.
constexpr bool UsesPrediction(Strategy strategy) noexcept {
  return strategy == Strategy::kPidEsn || strategy == Strategy::kComputedTorque;
}

enum class DerivativeOf { kError, kMeasurement };
enum class VelocityFrom { kOutputDifference, kOutput, kMotor };
enum class OnStale { kHold, kDamp };

struct JointControlConfig {
  Strategy strategy = Strategy::kPid;
  PidConfig pid;
  DerivativeOf derivative_of = DerivativeOf::kError;
  VelocityFrom velocity_from = VelocityFrom::kOutput;
  std::optional<actuator::JointModel> model;  // needed by kPidLinear
  CompensatorConfig compensator;              // kPidLinear only
  bool by_regime = true;  // kPidEsn: SEA or PEA by regime; else the predictor's own choice
  double gear_ratio = 1.0;
  double shaft_per_output = 1.0;       // 1 / (N efficiency)
  double motor_torque_limit_Nm = 0.0;  // more than 0
  double takeover_s = 0.3;
  double replay_takeover_s = 2.0;  // to a recording's reference on live hardware
  double crossfade_s = 0.02;
  double tracking_error_limit_rad = 0.0;  // 0: none
  double damping_Nm_s_rad = 0.3;          // of safe commands, at the output
  OnStale on_stale = OnStale::kHold;
  double stale_grace_s = 0.035;  // what a standby needs to take over: docs/safety.md
  double motion_acceleration_rad_s2 = 1.0;

  bool needs_regime() const noexcept { return strategy == Strategy::kPidEsn && by_regime; }
};

struct JointInput : CycleInput {
  const MeasuredJointState* measured = nullptr;
  bool reference_expected = false;  // the reference asks for this joint, or did when last heard
  Point reference;
  JointPrediction prediction;
  types::Regime regime = types::Regime::kUnknown;
  MotionOrder motion;
};

// The newest value of an input that comes every tick, and how old it is.
template <class Value>
class LateInput {
 public:
  // A cycle. `late_s`: of `value`, 0 when it is of this tick, kNoInput when there is none. False:
  // it is no newer than what was known.
  bool Take(const Value& value, double late_s, double period_s) noexcept {
    const double aged_s = std::min(late_s_ + period_s, 1e6);
    const bool newer = late_s <= 0.0 || late_s < (known_ ? aged_s - 0.5 * period_s : kNoInput);
    if (newer) {
      value_ = value;
      known_ = true;
    }
    late_s_ = newer ? late_s : aged_s;
    return newer;
  }
  void Forget() noexcept { *this = {}; }
  double late_s() const noexcept { return late_s_; }
  // The last value counts, late or not.
  bool Within(double grace_s) const noexcept { return known_ && late_s_ <= grace_s; }
  const Value& value() const noexcept { return value_; }
  template <class Archive>
  void Exchange(Archive& archive) {
    archive(value_, late_s_, known_);
  }

 private:
  Value value_{};
  double late_s_ = 0.0;
  bool known_ = false;
};

class JointController {
 public:
  // Throws std::invalid_argument with the value that is wrong.
  explicit JointController(const JointControlConfig& config);

  // Not armed: everything is forgotten. The command is idle.
  void Disarm() noexcept;
  struct Result {
    JointOutput output;
    bool stale = false;
    Fault fault = Fault::kNone;
  };
  Result Step(const JointInput& input) noexcept;

  // The robot gets another controller's commands, which differ from the own ones by this much: the
  // integral takes the difference, so that the commands go on from the other's when it is gone.
  // Without an integral, or at rest, nothing changes.
  void Follow(double difference_motor_torque_Nm) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  const JointControlConfig& config() const noexcept { return config_; }

 private:
  enum class Aim { kNone, kHold, kReference, kMove, kPush };

  // Puts the last values in the place of what is late, until it is lost.
  void BridgeLateInputs(JointInput* input) noexcept;
  void ChooseAim(const JointInput& input) noexcept;
  Point Target(const JointInput& input) noexcept;
  double MeasuredVelocity(const MeasuredJointState& m, double period_s) noexcept;
  bool PredictionCounts(const JointInput& input) const noexcept;
  double FeedForward(const JointInput& input, const Point& target) noexcept;
  JointOutput Damping(const MeasuredJointState& m) const noexcept;
  JointOutput Push(const JointInput& input) noexcept;
  void SetTorque(double wanted_Nm, JointOutput* output) const noexcept;  // within its limit
  // The command of a cycle; returns the fault that latches.
  Fault Command(const JointInput& input, Result* result) noexcept;
  Fault Regulate(const JointInput& input, double velocity_rad_s, JointOutput* output) noexcept;

  JointControlConfig config_;
  Pid pid_;
  std::optional<Compensator> compensator_;

  bool started_ = false;
  Fault latched_ = Fault::kNone;
  Aim aim_ = Aim::kNone;
  Point target_;             // of the last tick
  double offset_rad_ = 0.0;  // fades out over takeover_s
  double offset_age_s_ = 0.0;
  double offset_fades_s_ = 0.0;
  bool replayed_ = false;  // the reference that is followed
  LateInput<Point> last_reference_;
  LateInput<JointPrediction> last_prediction_;
  LateInput<types::Regime> last_regime_;
  MotionOrder motion_;  // being executed
  std::optional<reference::Move> move_;
  double move_age_s_ = 0.0;
  double push_at_rad_ = 0.0;
  double last_position_rad_ = 0.0;
  bool last_position_known_ = false;
  MeasuredJointState last_actuator_;  // last valid
  int source_ = 0;                // of the feed-forward: 0 none, 1 model, 2 SEA, 3 PEA, 4 network
  double feed_forward_Nm_ = 0.0;  // applied in the last tick
  double fade_Nm_ = 0.0;
  double integral_alone_Nm_ = 0.0;  // where the feed-forward ended
};

}  // namespace sinew::control
