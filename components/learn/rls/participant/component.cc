#include "components/learn/rls/participant/component.h"

#include <spdlog/spdlog.h>

#include "components/learn/rls/participant/adaptation.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/snapshot.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::rls {
namespace {

// Of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kRlsStateVersion = 1;

class RlsComponent final : public node::Component {
 public:
  RlsComponent(const node::Options& options, node::StopFlag& stop, const RlsConfig& config)
      : adaptation_(config), node_(options), loop_(node_, stop), inputs_(loop_) {}
  ~RlsComponent() override { spdlog::info("{} updates", adaptation_.updates()); }

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    while (const auto other = owner_.TakeNext(*tick)) adaptation_.Follow(*other, *tick);
    (void)owner_.StandsBy(*tick);
    const Outputs outputs = adaptation_.Step(inputs_, *tick);
    loop_.Publish(readout_, outputs.readout, *tick);
    loop_.Publish(state_, outputs.adaptation, *tick);
    snapshots_.Cycle(*tick);
    return true;
  }
  void Resume(const node::SavedState& saved) override {
    node::SkipCycle(loop_);
    snapshots_.Restore(saved);
  }

 private:
  Adaptation adaptation_;
  node::Node node_;
  node::TickLoop loop_;
  Inputs inputs_;
  node::Writer<msg::Readout> readout_ = node_.MakeWriter(node::kReadout);
  node::Writer<msg::AdaptationState> state_ = node_.MakeWriter(node::kAdaptationState);
  node::Snapshots<Adaptation> snapshots_{node_, kRlsStateVersion, &adaptation_};
  node::OtherOwner<msg::Readout> owner_{node_, node::kReadout};
};

}  // namespace

std::unique_ptr<node::Component> MakeRls(const node::Options& options, node::StopFlag& stop,
                                         const esn::WeightsPaths& given) {
  return std::make_unique<RlsComponent>(options, stop, LoadRlsConfig(options.config_path, given));
}

}  // namespace sinew::rls
