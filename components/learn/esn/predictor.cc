#include "components/learn/esn/predictor.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::esn {
namespace {

constexpr std::string_view kTarget = "drive_torque_Nm";

void CheckNetwork(const Weights& weights, const char* name) {
  if (weights.inputs.empty())
    throw std::invalid_argument(std::string(name) + ": the inputs have no names");
  if (weights.target != kTarget) {
    throw std::invalid_argument(std::string(name) + ": target '" + weights.target +
                                "', expected '" + std::string(kTarget) + "'");
  }
  if (weights.output_count() > types::kMaxJoints) {
    throw std::invalid_argument(std::string(name) + ": " + std::to_string(weights.output_count()) +
                                " outputs, expected at most " + std::to_string(types::kMaxJoints));
  }
}

}  // namespace

Predictor::Predictor(const std::optional<Weights>& sea, const std::optional<Weights>& pea) {
  if (!sea && !pea) throw std::invalid_argument("networks: none, expected a SEA or a PEA network");
  if (sea && pea) {
    if (sea->output_count() != 1 || pea->output_count() != 1) {
      throw std::invalid_argument("networks: " + std::to_string(sea->output_count()) + " and " +
                                  std::to_string(pea->output_count()) +
                                  " outputs, expected 1 each where the regime chooses between two");
    }
    if (std::abs(sea->period_s - pea->period_s) > 1e-9) {
      throw std::invalid_argument("networks: periods " + std::to_string(sea->period_s) + " s and " +
                                  std::to_string(pea->period_s) + " s, expected the same");
    }
  }
  const std::optional<Weights>* const both[] = {&sea, &pea};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::optional<Weights>& weights = *both[i];
    if (!weights) continue;
    CheckNetwork(*weights, i == 0 ? "sea" : "pea");
    slots_[i].emplace(
        Slot{Network(*weights), weights->inputs, Eigen::VectorXd::Zero(weights->input_count())});
    for (const Input& input : weights->inputs)
      needs_regime_ = needs_regime_ || input.signal == Signal::kPlayAngle;
    period_s_ = weights->period_s;
    outputs_ = weights->output_count();
  }
  needs_regime_ = needs_regime_ || (sea && pea);
}

void Predictor::Reset() noexcept {
  for (auto& slot : slots_) {
    if (!slot) continue;
    slot->network.Reset();
    slot->settled = false;
  }
}

Prediction Predictor::Step(const Frame& frame, types::Regime regime) noexcept {
  Prediction prediction;
  prediction.joint_count = outputs_;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!slots_[i]) continue;
    Slot& slot = *slots_[i];
    for (std::size_t m = 0; m < slot.inputs.size(); ++m) {
      slot.u(static_cast<Eigen::Index>(m)) = frame.Get(slot.inputs[m]);
    }
    const StepStatus status =
        slot.settled ? slot.network.Step(slot.u) : slot.network.Settle(slot.u);
    slot.settled = slot.settled || status == StepStatus::kOk;
    slot.good = status == StepStatus::kOk && slot.network.prediction().allFinite();
    if (!slot.good) continue;
    auto& torque = i == 0 ? prediction.sea_torque_Nm : prediction.pea_torque_Nm;
    for (int j = 0; j < outputs_; ++j)
      torque[static_cast<std::size_t>(j)] = slot.network.prediction()(j);
  }

  const bool both = slots_[0] && slots_[1];
  if (both && regime == types::Regime::kUnknown) return prediction;
  const bool use_sea = both ? regime == types::Regime::kSea : slots_[0].has_value();
  const Which which = use_sea ? Which::kSea : Which::kPea;
  if (!slots_[Index(which)]->good) return prediction;
  prediction.chosen = which;
  const auto& torque = use_sea ? prediction.sea_torque_Nm : prediction.pea_torque_Nm;
  for (std::size_t j = 0; j < static_cast<std::size_t>(outputs_); ++j) {
    prediction.torque_Nm[j] = torque[j];
    prediction.valid[j] = true;
  }
  if (!slots_[0]) prediction.sea_torque_Nm = prediction.torque_Nm;
  if (!slots_[1]) prediction.pea_torque_Nm = prediction.torque_Nm;
  return prediction;
}

bool Predictor::SetReadout(Which which, std::uint64_t version,
                           const Eigen::Ref<const Eigen::MatrixXd>& readout) noexcept {
  std::optional<Slot>& slot = slots_[Index(which)];
  if (!slot || !slot->network.SetReadout(readout)) return false;
  slot->version = version;
  return true;
}

}  // namespace sinew::esn
