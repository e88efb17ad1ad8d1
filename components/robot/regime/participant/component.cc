#include "components/robot/regime/participant/component.h"

#include <spdlog/spdlog.h>

#include <optional>
#include <string>

#include "components/robot/regime/file/regime_file.h"
#include "components/robot/regime/participant/translate.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/snapshot.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::regime {
namespace {

RegimeConfig LoadConfig(const std::filesystem::path& path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-regime/1");
  }
  return LoadRegime(path);
}

// Of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kRegimeStateVersion = 1;

class RegimeComponent final : public node::Component {
 public:
  RegimeComponent(const node::Options& options, node::StopFlag& stop)
      : RegimeComponent(LoadConfig(options.config_path), options, stop) {}

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    robot_.Follow(*tick, &owner_);
    robot_.Step(*tick, state_.value(), actuator_);
    loop_.Publish(output_, ToMessage(robot_, *tick), *tick);
    if (requests_) loop_.Publish(*requests_, ToRequest(robot_), *tick);
    snapshots_.Cycle(*tick);
    Report(robot_.Trouble());
    return true;
  }
  void Resume(const node::SavedState& saved) override {
    node::SkipCycle(loop_);
    snapshots_.Restore(saved);
  }

 private:
  RegimeComponent(const RegimeConfig& config, const node::Options& options, node::StopFlag& stop)
      : robot_(config.joints), node_(options), loop_(node_, stop) {
    if (config.requests_motion()) requests_.emplace(node_.MakeWriter(node::kMotionRequest));
  }
  void Report(const std::string& trouble) {
    if (trouble == reported_) return;
    reported_ = trouble;
    if (!trouble.empty()) spdlog::warn("{}", trouble);
    node_.SetState(trouble.empty() ? node::Node::State::kActive : node::Node::State::kFault,
                   trouble);
  }

  RobotRegime robot_;
  node::Node node_;
  node::TickLoop loop_;
  node::TickInput<msg::JointState>& state_ = loop_.AddInput(node::kJointState);
  node::TickInput<msg::ActuatorState>& actuator_ = loop_.AddInput(node::kActuatorState);
  node::Writer<msg::RegimeState> output_ = node_.MakeWriter(node::kRegime);
  std::optional<node::Writer<msg::MotionRequest>> requests_;
  node::Snapshots<RobotRegime> snapshots_{node_, kRegimeStateVersion, &robot_};
  node::OtherOwner<msg::RegimeState> owner_{node_, node::kRegime};
  std::string reported_;
};

}  // namespace

std::unique_ptr<node::Component> MakeRegime(const node::Options& options, node::StopFlag& stop) {
  return std::make_unique<RegimeComponent>(options, stop);
}

}  // namespace sinew::regime
