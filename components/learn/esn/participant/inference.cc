#include "components/learn/esn/participant/inference.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/regime.h"
#include "components/base/types/state_archive.h"

namespace sinew::esn {
namespace {

// Bounds of the topics (idl/learning.idl).
constexpr int kMostFeatures = 640;
// The provider's period may differ from the trained one by this share without a warning.
constexpr double kSamePeriod = 0.02;

bool Reads(const std::optional<Weights>& weights, std::initializer_list<Signal> signals) {
  return weights &&
         std::any_of(weights->inputs.begin(), weights->inputs.end(), [&](const Input& input) {
           return std::find(signals.begin(), signals.end(), input.signal) != signals.end();
         });
}

bool Reads(const EsnConfig& config, std::initializer_list<Signal> signals) {
  return Reads(config.sea, signals) || Reads(config.pea, signals);
}

// Fills the frame from an input if it is read and has a sample; false: something is old or lost.
template <class Message>
bool Fill(const node::TickInput<Message>* input, Frame* frame) {
  if (input == nullptr) return true;
  if (!input->has_value()) return false;
  const bool good = FillFrom(input->value(), frame);
  return good && input->fresh();
}

}  // namespace

Inference::Inference(const EsnConfig& config) {
  try {
    if (config.mode == EsnConfig::Mode::kInverseDynamics) {
      inverse_.emplace(config.inverse_dynamics);
      return;
    }
    predictor_.emplace(config.sea, config.pea);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  for (const Which which : {Which::kSea, Which::kPea}) {
    if (predictor_->has(which) && predictor_->network(which).feature_count() > kMostFeatures) {
      throw UsageError("weights: " + std::to_string(predictor_->network(which).feature_count()) +
                       " features, expected at most " + std::to_string(kMostFeatures) +
                       " (1 + inputs + neurons)");
    }
  }
  needs_actuator_state_ =
      Reads(config, {Signal::kMotorVelocity, Signal::kChamberPressure, Signal::kLoadForce,
                     Signal::kPayload, Signal::kTemperature});
  needs_reference_ = Reads(config, {Signal::kReferencePosition, Signal::kReferenceVelocity,
                                    Signal::kReferenceAcceleration, Signal::kReferenceDirection});
  needs_regime_ = predictor_->needs_regime();
  needs_readout_ = config.adaptation;
}

Outputs Inference::Step(const Inputs& inputs, const node::Tick& tick) {
  if (session_id_ != tick.session_id) {
    session_id_ = tick.session_id;
    if (predictor_) {
      predictor_->Reset();
      if (std::abs(tick.nominal_period_s - predictor_->period_s()) >
          kSamePeriod * predictor_->period_s()) {
        spdlog::warn("the networks were trained at {:.2f} Hz, the robot runs at {:.2f} Hz",
                     1.0 / predictor_->period_s(), 1.0 / tick.nominal_period_s);
      }
    }
    if (inverse_) inverse_->Reset();
  }
  if (inputs.readout != nullptr && inputs.readout->has_value()) {
    const auto version = [&](Which which) {
      return predictor_->has(which) ? predictor_->readout_version(which) : 0;
    };
    const std::uint64_t before = version(Which::kSea) + version(Which::kPea);
    if (!TakeReadout(inputs.readout->value(), &*predictor_)) {
      if (readouts_refused_++ == 0) spdlog::warn("readout refused: it does not fit the network");
    } else if (version(Which::kSea) + version(Which::kPea) != before) {
      ++readouts_taken_;
    }
  }

  Frame frame;
  bool good = Fill(&inputs.state, &frame);
  good = Fill(inputs.actuator, &frame) && good;
  good = Fill(inputs.reference, &frame) && good;
  good = Fill(inputs.regime, &frame) && good;
  const types::Regime regime = inputs.regime != nullptr && inputs.regime->has_value()
                                   ? RegimeOf(inputs.regime->value())
                                   : types::Regime::kUnknown;
  const Prediction prediction =
      inverse_ ? inverse_->Step(frame, tick.period_s) : predictor_->Step(frame, regime);

  Outputs outputs;
  outputs.prediction = ToMessage(prediction);
  outputs.prediction.stale = !good;
  if (predictor_) {
    outputs.reservoir = ReservoirMessage(prediction, *predictor_);
    outputs.prediction.readout_version = outputs.reservoir.readout_version;
  }
  return outputs;
}

void Inference::Exchange(types::StateArchive& archive) {
  archive(predictor_, inverse_, session_id_);
}

}  // namespace sinew::esn
