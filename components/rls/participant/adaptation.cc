#include "components/rls/participant/adaptation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/config/config.h"

namespace sinew::rls {
namespace {

std::optional<Eigen::MatrixXd> ReadoutOf(const std::optional<esn::Weights>& weights) {
  if (!weights) return std::nullopt;
  return weights->readout;
}

Adapter MakeAdapter(const RlsConfig& config) {
  try {
    return Adapter(config.adapter, ReadoutOf(config.sea), ReadoutOf(config.pea));
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

Adaptation::Adaptation(const RlsConfig& config)
    : robot_(config.robot), target_kind_(config.target), adapter_(MakeAdapter(config)) {}

double Adaptation::DriveTorque(std::size_t joint, const msg::ActuatorState& actuator,
                               const msg::JointCommand& command) const {
  const actuator::JointModel& model = robot_.joints[joint];
  const bool volts = model.Find("drive_voltage") >= 0;
  effects::JointSample sample;
  if (target_kind_ == TargetKind::kMeasured) {
    sample.drive_input = volts ? actuator.drive_voltage_V()[joint] : actuator.motor_current_A()[joint];
  } else {
    const double per_input = volts ? model.constants.force_constant_N_V : model.constants.torque_constant_Nm_A;
    sample.drive_input = command.motor_torque_Nm()[joint] / per_input;
  }
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
  return model.Torque(effects::Role::kDrive, sample, memory);
}

// Fills target_Nm_; false: there is none this tick.
bool Adaptation::Target(const Inputs& inputs, int outputs) {
  const msg::JointState& state = inputs.state.value();
  const msg::JointCommand& command = inputs.command.value();
  if (!inputs.command.fresh() || command.stale()) return false;
  if (outputs > state.joint_count() || outputs > command.joint_count()) return false;
  const bool measured = target_kind_ == TargetKind::kMeasured;
  if (measured && (!inputs.actuator.fresh() || outputs > inputs.actuator.value().joint_count())) return false;
  target_Nm_.resize(outputs);
  for (std::size_t j = 0; j < static_cast<std::size_t>(outputs); ++j) {
    if (command.mode()[j] != msg::COMMAND_TORQUE || !state.valid()[j]) return false;
    if (measured && !inputs.actuator.value().valid()[j]) return false;
    target_Nm_(static_cast<Eigen::Index>(j)) = DriveTorque(j, inputs.actuator.value(), command);
  }
  return true;
}

Outputs Adaptation::Step(const Inputs& inputs, const node::Tick& tick) {
  if (session_id_ != tick.session_id) {
    session_id_ = tick.session_id;
    adapter_.Reset();
    updates_ = 0;
  }
  const msg::JointState& state = inputs.state.value();
  const msg::ReservoirState& reservoir = inputs.reservoir.value();
  const int outputs = reservoir.output_count();
  const bool has_features = inputs.reservoir.fresh() && reservoir.feature_count() > 0 &&
                            reservoir.feature().size() == reservoir.feature_count();
  features_ = Eigen::Map<const Eigen::VectorXd>(reservoir.feature().data(),
                                                has_features ? reservoir.feature_count() : 0);
  double fastest = 0.0;
  for (std::size_t j = 0; j < std::min<std::size_t>(state.joint_count(), state.velocity_rad_s().size()); ++j) {
    fastest = std::max(fastest, std::abs(state.velocity_rad_s()[j]));
  }
  const bool usable = has_features && outputs > 0 && Target(inputs, outputs);
  const Frozen frozen = adapter_.Step({.armed = state.robot_state() == msg::ROBOT_ARMED,
                                       .usable = usable,
                                       .fastest_velocity_rad_s = fastest,
                                       .period_s = tick.period_s,
                                       .network = reservoir.network(),
                                       .features = features_,
                                       .target_Nm = target_Nm_});
  if (frozen == Frozen::kNo) ++updates_;

  const int network = adapter_.network();
  const RecursiveLeastSquares& estimator = adapter_.estimator(network);
  const RecursiveLeastSquares::Readout weights = estimator.readout();
  Outputs out;
  out.readout.version(adapter_.version(network));
  out.readout.network(static_cast<std::uint8_t>(network));
  out.readout.output_count(static_cast<std::uint8_t>(estimator.output_count()));
  out.readout.feature_count(static_cast<std::uint16_t>(estimator.feature_count()));
  out.readout.weight().reserve(static_cast<std::size_t>(weights.size()));
  for (Eigen::Index o = 0; o < weights.rows(); ++o) {
    for (Eigen::Index i = 0; i < weights.cols(); ++i) out.readout.weight().push_back(weights(o, i));
  }

  out.adaptation.version(out.readout.version());
  out.adaptation.state_tick(inputs.state.tick());
  out.adaptation.stale(tick.any_stale);
  out.adaptation.frozen(frozen != Frozen::kNo);
  out.adaptation.output_count(out.readout.output_count());
  if (frozen == Frozen::kNo) {
    for (int o = 0; o < estimator.output_count(); ++o) {
      out.adaptation.innovation_Nm()[static_cast<std::size_t>(o)] = estimator.innovation()(o);
    }
  }
  if (estimator.updates() > 0) {
    out.adaptation.clipped_share(static_cast<double>(estimator.clipped()) /
                                 static_cast<double>(estimator.updates()));
  }
  out.adaptation.covariance_trace(estimator.CovarianceTrace());
  return out;
}

}  // namespace sinew::rls
