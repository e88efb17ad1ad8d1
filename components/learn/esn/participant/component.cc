#include "components/learn/esn/participant/component.h"

#include <spdlog/spdlog.h>

#include "components/learn/esn/participant/inference.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/snapshot.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::esn {
namespace {

// Of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kEsnStateVersion = 1;

class EsnComponent final : public node::Component {
 public:
  EsnComponent(const node::Options& options, node::StopFlag& stop, const EsnConfig& config)
      : inference_(config), node_(options), loop_(node_, stop), inputs_(loop_, inference_) {}
  ~EsnComponent() override {
    spdlog::info("{} readouts taken, {} refused", inference_.readouts_taken(),
                 inference_.readouts_refused());
  }

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    owner_.Watch(*tick);
    const Outputs outputs = inference_.Step(inputs_, *tick);
    loop_.Publish(prediction_, outputs.prediction, *tick);
    loop_.Publish(reservoir_, outputs.reservoir, *tick);
    snapshots_.Cycle(*tick);
    return true;
  }
  void Resume(const node::SavedState& saved) override {
    node::SkipCycle(loop_);
    snapshots_.Restore(saved);
  }

 private:
  Inference inference_;
  node::Node node_;
  node::TickLoop loop_;
  Inputs inputs_;
  node::Writer<msg::TorquePrediction> prediction_ = node_.MakeWriter(node::kTorquePrediction);
  node::Writer<msg::ReservoirState> reservoir_ = node_.MakeWriter(node::kReservoirState);
  node::Snapshots<Inference> snapshots_{node_, kEsnStateVersion, &inference_};
  node::OtherOwner<msg::TorquePrediction> owner_{node_, node::kTorquePrediction};
};

}  // namespace

std::unique_ptr<node::Component> MakeEsn(const node::Options& options, node::StopFlag& stop,
                                         const WeightsPaths& given) {
  return std::make_unique<EsnComponent>(options, stop, LoadEsnConfig(options.config_path, given));
}

}  // namespace sinew::esn
