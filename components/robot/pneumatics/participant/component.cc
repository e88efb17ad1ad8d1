#include "components/robot/pneumatics/participant/component.h"

#include <spdlog/spdlog.h>

#include <string>

#include "components/robot/pneumatics/participant/translate.h"
#include "components/topics/node/snapshot.h"

namespace sinew::pneumatics {
namespace {

PneumaticsConfig LoadConfig(const std::filesystem::path& path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-pneumatics/1");
  }
  return LoadPneumatics(path);
}

// Of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kPneumaticsStateVersion = 1;

class PneumaticsComponent final : public node::Component {
 public:
  PneumaticsComponent(const node::Options& options, node::StopFlag& stop)
      : PneumaticsComponent(LoadConfig(options.config_path), options, stop) {}

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    robot_.Step(*tick);
    loop_.Publish(command_, robot_.Command(), *tick);
    loop_.Publish(state_, robot_.State(*tick), *tick);
    snapshots_.Cycle(*tick);
    Report(robot_.Trouble());
    return true;
  }
  void Resume(const node::SavedState& saved) override {
    node::SkipCycle(loop_);
    snapshots_.Restore(saved);
  }

 private:
  PneumaticsComponent(const PneumaticsConfig& config, const node::Options& options,
                      node::StopFlag& stop)
      : node_(options), loop_(node_, stop), robot_(node_, loop_, config) {}
  void Report(const std::string& trouble) {
    if (trouble == reported_) return;
    reported_ = trouble;
    if (!trouble.empty()) spdlog::error("{}", trouble);
    node_.SetState(trouble.empty() ? node::Node::State::kActive : node::Node::State::kFault,
                   trouble);
  }

  node::Node node_;
  node::TickLoop loop_;
  RobotPneumatics robot_;
  node::Writer<msg::ValveCommand> command_ = node_.MakeWriter(node::kValveCommand);
  node::Writer<msg::PneumaticState> state_ = node_.MakeWriter(node::kPneumaticState);
  node::Snapshots<RobotPneumatics> snapshots_{node_, kPneumaticsStateVersion, &robot_};
  std::string reported_;
};

}  // namespace

std::unique_ptr<node::Component> MakePneumatics(const node::Options& options,
                                                node::StopFlag& stop) {
  return std::make_unique<PneumaticsComponent>(options, stop);
}

}  // namespace sinew::pneumatics
