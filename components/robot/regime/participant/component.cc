#include "components/robot/regime/participant/component.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/regime.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "components/base/types/joints.h"
#include "components/base/types/motion.h"
#include "components/base/types/robot_state.h"
#include "components/base/types/state_archive.h"
#include "components/robot/regime/detector.h"
#include "components/robot/regime/file/regime_file.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_component.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::regime {
namespace {

// Messages to and from the regime detectors of all joints.
struct RobotRegime {
  std::vector<RegimeDetector> detectors;
  types::JointArray<DetectorOutput> output{};
  bool stale = false;
  bool standby = false;

  explicit RobotRegime(const std::vector<DetectorConfig>& joints) {
    for (const DetectorConfig& joint : joints) detectors.emplace_back(joint);
  }
  // A standby's, before Step: the owner's setup counts here. owner_heard: another detector is the
  // owner; this one asks for no motion.
  void Follow(const node::Tick& tick, node::OtherOwner<msg::RegimeState>* owner) {
    while (const auto message = owner->TakeNext(tick)) {
      const Gaps& then = gaps_[message->header.tick % kTicksKept];
      if (!then.known || then.tick != message->header.tick) continue;
      for (std::size_t j = 0; j < detectors.size() && j < message->joint_count; ++j) {
        if (message->phase[j] != msg::RegimePhase::kExecution) continue;
        detectors[j].Adopt(tick.session_id, then.gap_rad[j] - message->play_angle_rad[j]);
      }
    }
    standby = owner->StandsBy(tick);
  }
  void Step(const node::Tick& tick, const msg::JointState& state,
            const node::TickInput<msg::ActuatorState>& actuator) {
    stale = !actuator.fresh();
    Gaps& gaps = gaps_[tick.tick % kTicksKept];
    gaps.tick = tick.tick;
    gaps.known = !stale;
    for (std::size_t j = 0; j < detectors.size(); ++j) {
      DetectorInput input;
      input.session_id = tick.session_id;
      input.period_s = tick.period_s;
      input.armed = !standby && types::MayMove(state.robot_state);
      if (!stale && j < state.joint_count && j < actuator.value().joint_count) {
        const msg::ActuatorState& inside = actuator.value();
        input.valid = state.valid[j] && inside.valid[j];
        input.motor_position_rad = inside.motor_position_rad[j];
        input.output_position_rad = state.position_rad[j];
        input.output_velocity_rad_s = state.velocity_rad_s[j];
        input.pressure_bar = inside.chamber_pressure_bar[j];
      }
      gaps.gap_rad[j] =
          input.motor_position_rad / detectors[j].config().gear_ratio - input.output_position_rad;
      gaps.known = gaps.known && input.valid;
      output[j] = detectors[j].Step(input);
    }
  }
  // The first trouble and its joint, one line; empty: none.
  std::string Trouble() const {
    for (std::size_t j = 0; j < detectors.size(); ++j) {
      if (output[j].trouble == Trouble::kNone) continue;
      return "joint " + std::to_string(j) + ": " + TroubleText(output[j].trouble);
    }
    return "";
  }
  // The output of a step is made anew.
  void Exchange(types::StateArchive& archive) { archive(detectors, gaps_); }

 private:
  // motor / N - output of the last ticks, by tick: the owner's answer comes some ticks later.
  static constexpr std::size_t kTicksKept = 32;
  struct Gaps {
    std::uint64_t tick = 0;
    bool known = false;
    types::JointArray<double> gap_rad{};

    void Exchange(types::StateArchive& archive) { archive(tick, known, gap_rad); }
  };
  std::array<Gaps, kTicksKept> gaps_;
};

msg::RegimeState ToMessage(const RobotRegime& robot, const node::Tick& tick) {
  msg::RegimeState message;
  message.state_tick = tick.tick;
  message.stale = robot.stale;
  message.joint_count = static_cast<std::uint8_t>(robot.detectors.size());
  for (std::size_t j = 0; j < robot.detectors.size(); ++j) {
    const DetectorOutput& out = robot.output[j];
    message.phase[j] = out.phase;
    message.regime[j] = out.regime;
    message.contact[j] = out.contact;
    message.play_angle_rad[j] = out.alpha_rad;
    message.backlash_rad[j] = robot.detectors[j].config().play.backlash_rad;
    message.confidence[j] = out.confidence;
  }
  return message;
}

msg::MotionRequest ToRequest(const RobotRegime& robot) {
  msg::MotionRequest message;
  message.requester = "regime";
  message.joint_count = static_cast<std::uint8_t>(robot.detectors.size());
  for (std::size_t j = 0; j < robot.detectors.size(); ++j) {
    const DetectorOutput& out = robot.output[j];
    const DetectorConfig& config = robot.detectors[j].config();
    message.kind[j] = out.request;
    if (out.request == types::Motion::kNone) continue;
    message.target_rad[j] = out.request_target_rad;
    message.velocity_limit_rad_s[j] = config.velocity_rad_s;
    message.motor_torque_limit_Nm[j] =
        out.request == types::Motion::kHold ? 0.0 : config.motor_torque_limit_Nm;
    message.pressure_bar[j] = out.request_pressure_bar;
  }
  return message;
}

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kRegimeStateVersion = 1;

class RegimeComponent final : public node::TickComponent {
 public:
  RegimeComponent(const node::Options& options, node::StopFlag& stop, const RegimeConfig& config)
      : TickComponent(options, stop), robot_(config.joints) {
    if (config.requests_motion()) requests_.emplace(node().MakeWriter(node::kMotionRequest));
    Keep(kRegimeStateVersion, &robot_);
  }

 private:
  void Compute(node::Tick& tick) override {
    robot_.Follow(tick, &owner_);
    robot_.Step(tick, state_.value(), actuator_);
    loop().Publish(output_, ToMessage(robot_, tick), tick);
    if (requests_) loop().Publish(*requests_, ToRequest(robot_), tick);
    Report(robot_.Trouble());
  }

  RobotRegime robot_;
  node::TickInput<msg::JointState>& state_ = loop().AddInput(node::kJointState);
  node::TickInput<msg::ActuatorState>& actuator_ = loop().AddInput(node::kActuatorState);
  node::Writer<msg::RegimeState> output_ = node().MakeWriter(node::kRegime);
  std::optional<node::Writer<msg::MotionRequest>> requests_;
  node::OtherOwner<msg::RegimeState> owner_{node(), node::kRegime};
};

}  // namespace

std::unique_ptr<node::Component> MakeRegime(const node::Options& options, node::StopFlag& stop) {
  return std::make_unique<RegimeComponent>(options, stop, LoadRegime(options.config_path));
}

}  // namespace sinew::regime
