#include "components/robot/reference/participant/component.h"

#include <spdlog/spdlog.h>

#include "components/robot/reference/file/reference_file.h"
#include "components/robot/reference/participant/translate.h"
#include "components/robot/reference/standby.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_component.h"

namespace sinew::reference {
namespace {

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kReferenceStateVersion = 1;

class ReferenceComponent final : public node::TickComponent {
 public:
  ReferenceComponent(const node::Options& options, node::StopFlag& stop,
                     const RobotReferenceConfig& config)
      : TickComponent(options, stop), generator_(config) {
    Keep(kReferenceStateVersion, &generator_);
  }

 private:
  void Compute(node::Tick& tick) override {
    RobotReferenceInput input = ToInput(tick, state_.value());
    starts_.AddTo(&input, state_.value().header.origin, &loop());
    while (const auto other = owner_.TakeNext(tick)) {
      generator_.Follow(other->header.tick, FromMessage(*other));
    }
    owner_.MarkOrigin(&tick);
    const RobotReferenceOutput now = generator_.Step(input, owner_.StandsBy(tick));
    loop().Publish(output_, ToMessage(now, tick), tick);
  }

  Standby generator_;
  node::TickInput<msg::JointState>& state_ = loop().AddInput(node::kJointState);
  OperatorStarts starts_{node()};
  node::Writer<msg::Reference> output_ = node().MakeWriter(node::kReference);
  node::OtherOwner<msg::Reference> owner_{node(), node::kReference};
};

}  // namespace

std::unique_ptr<node::Component> MakeReference(const node::Options& options, node::StopFlag& stop) {
  LoadedReference loaded = LoadReference(options.config_path);
  for (const std::string& note : loaded.notes) spdlog::info("{}", note);
  return std::make_unique<ReferenceComponent>(options, stop, loaded.config);
}

}  // namespace sinew::reference
