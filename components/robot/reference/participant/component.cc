#include "components/robot/reference/participant/component.h"

#include <spdlog/spdlog.h>

#include "components/robot/reference/file/reference_file.h"
#include "components/robot/reference/participant/translate.h"
#include "components/robot/reference/standby.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/snapshot.h"
#include "components/topics/node/tick_loop.h"
#include "components/topics/wire/wire.h"

namespace sinew::reference {
namespace {

RobotReferenceConfig LoadConfig(const std::filesystem::path& path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-reference/1");
  }
  LoadedReference loaded = LoadReference(path);
  for (const std::string& note : loaded.notes) spdlog::info("{}", note);
  return std::move(loaded.config);
}

// Of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kReferenceStateVersion = 1;

class ReferenceComponent final : public node::Component {
 public:
  ReferenceComponent(const node::Options& options, node::StopFlag& stop)
      : generator_(LoadConfig(options.config_path)), node_(options), loop_(node_, stop) {}

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    auto tick = loop_.Next();
    if (!tick) return false;
    RobotReferenceInput input = ToInput(*tick, state_.value());
    starts_.AddTo(&input, wire::FromWire(state_.value().header().origin()), &loop_);
    while (const auto other = owner_.TakeNext(*tick)) {
      generator_.Follow(other->header().tick(), FromMessage(*other));
    }
    owner_.MarkOrigin(&*tick);
    const RobotReferenceOutput now = generator_.Step(input, owner_.StandsBy(*tick));
    loop_.Publish(output_, ToMessage(now, *tick), *tick);
    snapshots_.Cycle(*tick);
    return true;
  }
  void Resume(const node::SavedState& saved) override {
    node::SkipCycle(loop_);
    snapshots_.Restore(saved);
  }

 private:
  Standby generator_;
  node::Node node_;
  node::TickLoop loop_;
  node::TickInput<msg::JointState>& state_ = loop_.AddInput(node::kJointState);
  OperatorStarts starts_{node_};
  node::Writer<msg::Reference> output_ = node_.MakeWriter(node::kReference);
  node::Snapshots<Standby> snapshots_{node_, kReferenceStateVersion, &generator_};
  node::OtherOwner<msg::Reference> owner_{node_, node::kReference};
};

}  // namespace

std::unique_ptr<node::Component> MakeReference(const node::Options& options, node::StopFlag& stop) {
  return std::make_unique<ReferenceComponent>(options, stop);
}

}  // namespace sinew::reference
