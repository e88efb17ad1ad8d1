#include "components/learn/esn/participant/inference.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/joints.h"
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

int Count(int joint_count) { return std::min(joint_count, types::kMaxJoints); }

// Signals of a message into the frame. Values of a joint that its message calls lost are its last
// known ones and are taken; the caller marks the prediction stale. False: some joint was lost.
bool FillFrom(const msg::JointState& message, Frame* frame) {
  bool all_valid = true;
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    frame->Set(Signal::kPosition, j, message.position_rad[at]);
    frame->Set(Signal::kVelocity, j, message.velocity_rad_s[at]);
    all_valid = all_valid && message.valid[at];
  }
  return all_valid;
}

bool FillFrom(const msg::ActuatorState& message, Frame* frame) {
  bool all_valid = true;
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    frame->Set(Signal::kMotorVelocity, j, message.motor_velocity_rad_s[at]);
    frame->Set(Signal::kChamberPressure, j, message.chamber_pressure_bar[at]);
    frame->Set(Signal::kLoadForce, j, message.load_force_N[at]);
    frame->Set(Signal::kPayload, j, message.declared_payload_kg[at]);
    frame->Set(Signal::kTemperature, j, message.motor_temperature_degC[at]);
    all_valid = all_valid && message.valid[at];
  }
  return all_valid;
}

bool FillFrom(const msg::Reference& message, Frame* frame) {
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    frame->Set(Signal::kReferencePosition, j, message.position_rad[at]);
    frame->Set(Signal::kReferenceVelocity, j, message.velocity_rad_s[at]);
    frame->Set(Signal::kReferenceAcceleration, j, message.acceleration_rad_s2[at]);
    frame->Set(Signal::kReferenceDirection, j, ReferenceDirection(message.velocity_rad_s[at]));
  }
  return !message.stale;
}

// The play angle is known while the regime is.
bool FillFrom(const msg::RegimeState& message, Frame* frame) {
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const bool known = message.regime[at] != types::Regime::kUnknown;
    frame->Set(Signal::kPlayAngle, j,
               known ? message.play_angle_rad[at] : std::numeric_limits<double>::quiet_NaN());
  }
  return !message.stale;
}

// Regime of the first joint.
types::Regime RegimeOf(const msg::RegimeState& message) {
  if (message.joint_count == 0) return types::Regime::kUnknown;
  return message.regime[0];
}

// Takes the readout of a message unless it is the one in use. False: it does not fit the network.
bool TakeReadout(const msg::Readout& message, Predictor* predictor) {
  if (message.feature_count == 0 || message.network > 1) return true;  // nothing to say yet
  const Which which = static_cast<Which>(message.network);
  if (!predictor->has(which)) return false;
  if (predictor->readout_version(which) == message.version) return true;
  const Eigen::Index rows = message.output_count;
  const Eigen::Index columns = message.feature_count;
  if (static_cast<std::size_t>(rows * columns) != message.weight.size()) return false;
  const Eigen::MatrixXd readout =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          message.weight.data(), rows, columns);
  return predictor->SetReadout(which, message.version, readout);
}

msg::TorquePrediction ToMessage(const Prediction& prediction) {
  msg::TorquePrediction message;
  message.joint_count = static_cast<std::uint8_t>(prediction.joint_count);
  message.torque_Nm = prediction.torque_Nm;
  message.sea_torque_Nm = prediction.sea_torque_Nm;
  message.pea_torque_Nm = prediction.pea_torque_Nm;
  message.valid = prediction.valid;
  return message;
}

// Features of the network that counted; feature_count 0: none did.
msg::ReservoirState ReservoirMessage(const Prediction& prediction, const Predictor& predictor) {
  msg::ReservoirState message;
  if (!prediction.chosen) return message;
  const Network& network = predictor.network(*prediction.chosen);
  message.network = static_cast<std::uint8_t>(*prediction.chosen);
  message.output_count = static_cast<std::uint8_t>(network.output_count());
  message.feature_count = static_cast<std::uint16_t>(network.feature_count());
  message.feature.assign(network.features().data(),
                         network.features().data() + network.feature_count());
  message.prediction_Nm = prediction.torque_Nm;
  message.readout_version = predictor.readout_version(*prediction.chosen);
  return message;
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
