#include "components/learn/rls/participant/component.h"

#include <spdlog/spdlog.h>

#include "components/learn/rls/participant/adaptation.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_component.h"

namespace sinew::rls {
namespace {

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kRlsStateVersion = 1;

class RlsComponent final : public node::TickComponent {
 public:
  RlsComponent(const node::Options& options, node::StopFlag& stop, const RlsConfig& config)
      : TickComponent(options, stop), adaptation_(config), inputs_(loop()) {
    Keep(kRlsStateVersion, &adaptation_);
  }
  ~RlsComponent() override { spdlog::info("{} updates", adaptation_.updates()); }

 private:
  void Compute(node::Tick& tick) override {
    while (const auto other = owner_.TakeNext(tick)) adaptation_.Follow(*other, tick);
    (void)owner_.StandsBy(tick);
    const Outputs outputs = adaptation_.Step(inputs_, tick);
    loop().Publish(readout_, outputs.readout, tick);
    loop().Publish(state_, outputs.adaptation, tick);
  }

  Adaptation adaptation_;
  Inputs inputs_;
  node::Writer<msg::Readout> readout_ = node().MakeWriter(node::kReadout);
  node::Writer<msg::AdaptationState> state_ = node().MakeWriter(node::kAdaptationState);
  node::OtherOwner<msg::Readout> owner_{node(), node::kReadout};
};

}  // namespace

std::unique_ptr<node::Component> MakeRls(const node::Options& options, node::StopFlag& stop,
                                         const esn::WeightsPaths& given) {
  return std::make_unique<RlsComponent>(options, stop, LoadRlsConfig(options.config_path, given));
}

}  // namespace sinew::rls
