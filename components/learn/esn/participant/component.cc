#include "components/learn/esn/participant/component.h"

#include <spdlog/spdlog.h>

#include "components/learn/esn/participant/inference.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_component.h"

namespace sinew::esn {
namespace {

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kEsnStateVersion = 1;

class EsnComponent final : public node::TickComponent {
 public:
  EsnComponent(const node::Options& options, node::StopFlag& stop, const EsnConfig& config)
      : TickComponent(options, stop), inference_(config), inputs_(loop(), inference_) {
    Keep(kEsnStateVersion, &inference_);
  }
  ~EsnComponent() override {
    spdlog::info("{} readouts taken, {} refused", inference_.readouts_taken(),
                 inference_.readouts_refused());
  }

 private:
  void Compute(node::Tick& tick) override {
    owner_.Watch(tick);
    const Outputs outputs = inference_.Step(inputs_, tick);
    loop().Publish(prediction_, outputs.prediction, tick);
    loop().Publish(reservoir_, outputs.reservoir, tick);
  }

  Inference inference_;
  Inputs inputs_;
  node::Writer<msg::TorquePrediction> prediction_ = node().MakeWriter(node::kTorquePrediction);
  node::Writer<msg::ReservoirState> reservoir_ = node().MakeWriter(node::kReservoirState);
  node::OtherOwner<msg::TorquePrediction> owner_{node(), node::kTorquePrediction};
};

}  // namespace

std::unique_ptr<node::Component> MakeEsn(const node::Options& options, node::StopFlag& stop,
                                         const WeightsPaths& given) {
  return std::make_unique<EsnComponent>(options, stop, LoadEsnConfig(options.config_path, given));
}

}  // namespace sinew::esn
