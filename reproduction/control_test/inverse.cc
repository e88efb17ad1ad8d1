#include "reproduction/control_test/inverse.h"

#include <Eigen/Core>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "sim/surrogate/surrogate.h"

namespace sinew::control_test {
namespace {

double Sum(const actuator::JointModel& model,
           std::initializer_list<std::pair<std::string_view, std::string_view>> parameters) {
  double sum = 0.0;
  for (const auto& [effect, parameter] : parameters) {
    if (model.Find(effect) >= 0) sum += model.Parameter(effect, parameter);
  }
  return sum;
}

}  // namespace

surrogate::RigParameters WithoutNoise(surrogate::RigParameters rig) {
  surrogate::SensorParameters& sensors = rig.sensors;
  sensors.encoder_counts = 1 << 26;
  sensors.motor_encoder_noise_rad = sensors.output_encoder_noise_rad = 0.0;
  sensors.current_noise_A = sensors.load_cell_noise_N = 0.0;
  sensors.pressure_noise_bar = sensors.temperature_noise_degC = 0.0;
  return rig;
}

Inverse InvertSurrogate(const InverseConfig& config) {
  if (config.loop.control.size() != 1 || !config.loop.control[0].model) {
    throw std::invalid_argument("inversion needs one joint with a model");
  }
  if (config.iterations < 1) throw std::invalid_argument("inversion needs a round at least");
  const double period_s = 1.0 / config.loop.rate_Hz;
  const identify::IirFilter filter =
      identify::ButterworthLowPass(2, config.cutoff_Hz, config.loop.rate_Hz);
  const actuator::JointModel& model = *config.loop.control[0].model;
  const double inertia_kg_m2 = Sum(model, {{"inertia", "inertia"},
                                           {"rotor_inertia", "rotor_inertia"},
                                           {"link_inertia", "link_inertia"}});
  const double viscous_Nm_s_rad =
      Sum(model, {{"viscous", "viscous"}, {"motor_viscous", "viscous"}});

  tune::ClosedLoopConfig loop = config.loop;
  control::JointControlConfig& joint = loop.control[0];
  joint.strategy = control::Strategy::kPid;
  joint.crossfade_s = 0.0;
  Inverse best;
  best.mse_rad2 = std::numeric_limits<double>::infinity();
  Eigen::VectorXd torque_Nm;
  for (int round = 0; round <= config.iterations; ++round) {
    if (round > 0) {
      joint.strategy = control::Strategy::kPidLinear;
      joint.compensator.kind = control::CompensatorKind::kRecorded;
      joint.compensator.recorded.period_s = period_s;
      joint.compensator.recorded.motor_torque_Nm.assign(torque_Nm.begin(), torque_Nm.end());
    }
    surrogate::Surrogate plant(WithoutNoise(config.rig));
    std::vector<tune::ClosedLoopTick> trace;
    const tune::ClosedLoopScore score = tune::RunClosedLoop(loop, plant, &trace);
    if (score.faulted) break;
    best.mse_by_round_rad2.push_back(score.mse_rad2);
    if (score.mse_rad2 < best.mse_rad2) {
      best.mse_rad2 = score.mse_rad2;
      best.torque = joint.compensator.recorded;
    }
    std::vector<double> feedback_Nm, error_rad;
    for (const tune::ClosedLoopTick& tick : trace) {
      if (tick.idle) continue;
      feedback_Nm.push_back(tick.motor_torque_Nm - tick.compensation_Nm);
      error_rad.push_back(tick.reference_rad - tick.position_rad);
    }
    const auto count = static_cast<Eigen::Index>(feedback_Nm.size());
    if (count < 10) throw std::invalid_argument("the reference never asked for anything");
    const auto smooth = [&](const std::vector<double>& values) {
      return identify::FilterZeroPhase(filter,
                                       Eigen::Map<const Eigen::VectorXd>(values.data(), count));
    };
    const Eigen::VectorXd error = smooth(error_rad);
    const Eigen::VectorXd rate = identify::WideDifference(error, period_s);
    const Eigen::VectorXd lacking_Nm =
        smooth(feedback_Nm) +
        joint.shaft_per_output *
            (inertia_kg_m2 * identify::WideDifference(rate, period_s) + viscous_Nm_s_rad * rate);
    if (round == 0) torque_Nm = Eigen::VectorXd::Zero(count);
    torque_Nm += config.gain * lacking_Nm;
  }
  if (best.torque.motor_torque_Nm.empty()) {
    throw std::invalid_argument("inversion did not converge: no round was better than the PID");
  }
  return best;
}

}  // namespace sinew::control_test
