#include "components/model/trace/machine_size.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/model/identify/statistics.h"
#include "components/model/trace/nuisances.h"

namespace sinew::trace {

namespace {

// The size where anything may be expected.
constexpr double kAny = std::numeric_limits<double>::infinity();

double SumOf(const actuator::JointModel& model, std::initializer_list<const char*> names) {
  double sum = 0.0;
  for (const char* name : names) {
    const int at = model.Find(name, model.balance);
    if (at >= 0) sum += std::abs(model.terms[static_cast<std::size_t>(at)].linear.front().value);
  }
  return sum;
}

}  // namespace

MachineSize SizeOf(const identify::Design& design, const UsedRows& used,
                   const actuator::JointModel& model) {
  const auto of_used = [&](auto variable) -> Eigen::VectorXd {
    return design.Variable(variable)(used.rows);
  };
  const auto highest = [](const Eigen::VectorXd& x) {
    return x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0;
  };
  using effects::JointSample;
  MachineSize out;
  out.drive_gain = std::abs(identify::NominalDriveGain(model));
  const Eigen::VectorXd drive =
      out.drive_gain * of_used([](const JointSample& x) { return x.drive_input; });
  out.drive_rms = identify::Rms(drive);
  out.drive_peak = highest(drive);
  out.quick = highest(of_used([](const JointSample& x) { return x.velocity_rad_s; }));
  if (design.states().measured.contains("pressure_bar")) {
    out.pressure_bar = highest(of_used([](const JointSample& x) { return x.pressure_bar; }));
  }
  out.inertia = identify::NominalInertia(model, effects::Side::kOutput) +
                identify::NominalInertia(model, effects::Side::kMotor);
  out.friction = DryFriction(model);
  if (!(out.friction > 0.0)) out.friction = 0.1 * out.drive_rms;
  out.viscous = SumOf(model, {"viscous", "motor_viscous"});
  if (!(out.viscous > 0.0) && out.quick > 0.0) out.viscous = out.friction / out.quick;
  out.gravity = SumOf(model, {"gravity"});
  if (!(out.gravity > 0.0)) out.gravity = out.drive_rms;
  return out;
}

double ExpectedSize(const effects::ParameterInfo& parameter, const MachineSize& machine,
                    const effects::JointConstants& constants) {
  constexpr double kShare = 0.3;       // of gains, of bodies and of what a chamber loses
  constexpr double kLag_s = 0.01;      // of drives, sensors and springs
  constexpr double kSensor = 0.05;     // of a sensor's highest reading
  constexpr double kPerKelvin = 0.02;  // of friction
  const double arm_m = std::max(constants.link_length_m, 1e-3);
  switch (parameter.dimension) {
    case effects::Dimension::kNone:
      return kShare;
    case effects::Dimension::kTorque:
      return machine.friction;
    case effects::Dimension::kViscous:
      return machine.viscous;
    case effects::Dimension::kQuadraticViscous:
      return machine.quick > 0.0 ? machine.viscous / machine.quick : kAny;
    case effects::Dimension::kInertia:
      return kShare * machine.inertia;
    case effects::Dimension::kInertiaTime:
      return kLag_s * machine.inertia;
    case effects::Dimension::kInertiaTimeSquared:
      return kLag_s * kLag_s * machine.inertia;
    case effects::Dimension::kTime:
      return kLag_s;
    case effects::Dimension::kMass:
      return kShare * machine.gravity / (constants.gravity_m_s2 * arm_m);
    case effects::Dimension::kTorquePerBar:
      return machine.pressure_bar > 0.0 ? machine.friction / machine.pressure_bar : kAny;
    case effects::Dimension::kPressure:
      return machine.pressure_bar > 0.0 ? kSensor * machine.pressure_bar : kAny;
    case effects::Dimension::kTorquePerKelvin:
      return kPerKelvin * machine.friction;
    case effects::Dimension::kViscousPerKelvin:
      return kPerKelvin * machine.viscous;
    case effects::Dimension::kCurrent:
      return machine.drive_gain > 0.0 ? machine.friction / machine.drive_gain : kAny;
    case effects::Dimension::kPerCurrentSquared: {
      const double peak = machine.drive_gain > 0.0 ? machine.drive_peak / machine.drive_gain : 0.0;
      return peak > 0.0 ? kShare / (peak * peak) : kAny;
    }
    default:
      return kAny;
  }
}

Range RangeOfAddition(const identify::Design& design, const actuator::JointModel& model,
                      const effects::Effect& effect, std::span<const double> psi,
                      std::size_t linear) {
  const effects::ParameterInfo& added = effect.info().linear[linear];
  if (added.dimension == effects::Dimension::kNone) return RangeOnAnyMachine(added);
  const Eigen::VectorXd column = design.Columns(effect, psi).col(static_cast<Eigen::Index>(linear));
  for (const actuator::Term& term : model.terms) {
    if (!term.declared || !model.Counts(term)) continue;
    const std::vector<effects::ParameterInfo>& infos = term.effect->info().linear;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      if (infos[i].dimension != added.dimension) continue;
      const Eigen::MatrixXd phi = design.Columns(*term.effect, actuator::NonlinearValues(term));
      if (phi.col(static_cast<Eigen::Index>(i)) != column) continue;
      const Range sum = RangeOnAnyMachine(infos[i]);
      const double value = term.linear[i].value;
      return {sum.lower - value, sum.upper - value};
    }
  }
  return RangeOnAnyMachine(added);
}

}  // namespace sinew::trace
