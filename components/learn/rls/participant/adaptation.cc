#include "components/learn/rls/participant/adaptation.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/control_mode.h"
#include "components/base/types/robot_state.h"
#include "components/base/types/state_archive.h"

namespace sinew::rls {
namespace {

std::optional<Eigen::MatrixXd> ReadoutOf(const std::optional<esn::Weights>& weights) {
  if (!weights) return std::nullopt;
  return weights->readout;
}

}  // namespace

Adaptation::Adaptation(const RlsConfig& config) try
    : robot_(config.robot),
      torque_from_(config.torque_from),
      equation_(config.target, config.robot, config.sea, config.pea),
      adapter_(config.adapter, ReadoutOf(config.sea), ReadoutOf(config.pea)) {
} catch (const std::invalid_argument& error) {
  throw UsageError(error.what());
}

double Adaptation::DriveTorque(std::size_t joint, const msg::ActuatorState& actuator,
                               const msg::JointCommand& command) const {
  const actuator::JointModel& model = robot_.joints[joint];
  const bool volts = model.Find("drive_voltage") >= 0;
  effects::JointSample sample;
  if (torque_from_ == TorqueFrom::kMeasured) {
    sample.drive_input = volts ? actuator.drive_voltage_V[joint] : actuator.motor_current_A[joint];
  } else {
    const double per_input =
        volts ? model.constants.force_constant_N_V : model.constants.torque_constant_Nm_A;
    sample.drive_input = command.motor_torque_Nm[joint] / per_input;
  }
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
  return model.Torque(effects::Role::kDrive, sample, memory);
}

// Features and command are those of the tick before; the rest is this tick's.
TickData Adaptation::Read(const Inputs& inputs, const node::Tick& tick) {
  const msg::JointState& state = inputs.state.value();
  const msg::ActuatorState& actuator = inputs.actuator.value();
  const msg::ReservoirState& reservoir = inputs.reservoir.value();
  const msg::JointCommand& command = inputs.command.value();
  const bool measured = torque_from_ == TorqueFrom::kMeasured;

  const bool has_features = inputs.reservoir.fresh() && reservoir.feature_count > 0 &&
                            reservoir.feature.size() == reservoir.feature_count;
  features_ = Eigen::Map<const Eigen::VectorXd>(reservoir.feature.data(),
                                                has_features ? reservoir.feature_count : 0);
  TickData data{.features = features_};
  data.tick = tick.tick;
  data.period_s = tick.nominal_period_s;
  data.network = reservoir.network;
  const std::size_t outputs = reservoir.output_count;
  data.usable = has_features && outputs > 0 && inputs.command.fresh() && !command.stale &&
                inputs.actuator.fresh() && outputs <= state.joint_count &&
                outputs <= command.joint_count && outputs <= actuator.joint_count;
  data.positions_valid = inputs.actuator.fresh();
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    data.position_rad[j] = state.position_rad[j];
    data.motor_position_rad[j] = actuator.motor_position_rad[j];
    data.drive_torque_Nm[j] = DriveTorque(j, actuator, command);
    const int joint = static_cast<int>(j);
    data.measured.Set(esn::Signal::kChamberPressure, joint, actuator.chamber_pressure_bar[j]);
    data.measured.Set(esn::Signal::kLoadForce, joint, actuator.load_force_N[j]);
    data.measured.Set(esn::Signal::kPayload, joint, actuator.declared_payload_kg[j]);
    data.measured.Set(esn::Signal::kTemperature, joint, actuator.motor_temperature_degC[j]);
    const bool valid = state.valid[j] && actuator.valid[j];
    if (j < outputs) {
      data.usable = data.usable && valid && command.mode[j] == types::ControlMode::kTorque;
      if (!measured && !std::isfinite(command.motor_torque_Nm[j])) data.usable = false;
    }
    data.positions_valid = data.positions_valid && valid;
  }
  return data;
}

void Adaptation::StartSession(const node::Tick& tick) {
  if (session_id_ == tick.session_id) return;
  session_id_ = tick.session_id;
  equation_.Reset();
  adapter_.Reset();
  updates_ = 0;
}

void Adaptation::Follow(const msg::Readout& owner, const node::Tick& tick) {
  StartSession(tick);
  const Eigen::Index rows = owner.output_count;
  const Eigen::Index columns = owner.feature_count;
  if (static_cast<std::size_t>(rows * columns) != owner.weight.size()) return;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd readout = Eigen::Map<const RowMajor>(owner.weight.data(), rows, columns);
  // One that does not fit is of other networks: there is nothing to follow.
  (void)adapter_.Adopt(owner.network, owner.version, readout);
}

Outputs Adaptation::Step(const Inputs& inputs, const node::Tick& tick) {
  StartSession(tick);
  const msg::JointState& state = inputs.state.value();
  double fastest_rad_s = 0.0;
  for (std::size_t j = 0; j < std::min<std::size_t>(state.joint_count, state.velocity_rad_s.size());
       ++j) {
    fastest_rad_s = std::max(fastest_rad_s, std::abs(state.velocity_rad_s[j]));
  }
  const std::optional<TargetEquation::Sample> sample = equation_.Push(Read(inputs, tick));
  const Eigen::VectorXd empty;
  const Eigen::Ref<const Eigen::VectorXd> none(empty);
  const Frozen frozen = adapter_.Step(
      {.armed = state.robot_state == types::RobotState::kArmed,
       .usable = sample.has_value(),
       .fastest_velocity_rad_s =
           sample ? std::max(fastest_rad_s, sample->fastest_velocity_rad_s) : fastest_rad_s,
       .period_s = tick.period_s,
       .network = sample ? sample->network : 0,
       .features = sample ? sample->features : none,
       .target_Nm = sample ? sample->target_Nm : none});
  if (frozen == Frozen::kNo) ++updates_;

  const int network = adapter_.network();
  const RecursiveLeastSquares& estimator = adapter_.estimator(network);
  const RecursiveLeastSquares::Readout weights = estimator.readout();
  Outputs out;
  out.readout.version = adapter_.version(network);
  out.readout.network = static_cast<std::uint8_t>(network);
  out.readout.output_count = static_cast<std::uint8_t>(estimator.output_count());
  out.readout.feature_count = static_cast<std::uint16_t>(estimator.feature_count());
  out.readout.weight.reserve(static_cast<std::size_t>(weights.size()));
  for (Eigen::Index o = 0; o < weights.rows(); ++o) {
    for (Eigen::Index i = 0; i < weights.cols(); ++i) out.readout.weight.push_back(weights(o, i));
  }

  out.adaptation.version = out.readout.version;
  out.adaptation.stale = tick.any_stale;
  out.adaptation.frozen = frozen != Frozen::kNo;
  out.adaptation.output_count = out.readout.output_count;
  if (frozen == Frozen::kNo) {
    for (int o = 0; o < estimator.output_count(); ++o) {
      out.adaptation.innovation_Nm[static_cast<std::size_t>(o)] = estimator.innovation()(o);
    }
  }
  if (estimator.updates() > 0) {
    out.adaptation.clipped_share =
        static_cast<double>(estimator.clipped()) / static_cast<double>(estimator.updates());
  }
  out.adaptation.covariance_trace = estimator.CovarianceTrace();
  return out;
}

void Adaptation::Exchange(types::StateArchive& archive) {
  archive(equation_, adapter_, session_id_, updates_);
}

}  // namespace sinew::rls
