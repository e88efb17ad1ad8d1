#include "components/model/trace/nuisances.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "components/model/identify/gas.h"

namespace sinew::trace {

namespace {

using effects::EffectInfo;
using effects::Smallest;

// Two channels sampled anywhere within one period: standard deviation of a uniform difference of
// half a period either way.
constexpr double kSkewSamples = 0.29;
// Half of what an opening may take (gas.h) as one standard deviation.
constexpr double kOpeningSpread = 0.5 * identify::kOpeningSamples;
// Teeth, bearings and the encoder's own mounting give: counts of the encoder at the torque's rms.
constexpr double kGivingCounts = 1.0;

// Every contact yields a little before it slides: over some counts of the encoder.
constexpr double kFewCounts = 8.0;

double Spread(const identify::Design& design, const actuator::JointModel& model,
              const EffectInfo& info, const Eigen::VectorXd& column) {
  const double period_s = 1.0 / design.states().rate_Hz;
  switch (info.smallest) {
    case Smallest::kTenthOfSample:
      return kSkewSamples * period_s;
    case Smallest::kOpening:
      return kOpeningSpread * period_s;
    case Smallest::kBandwidth: {
      const double edge = 2.0 * std::numbers::pi * design.options().state_cutoff_Hz;
      const double inertia = identify::NominalInertia(model, effects::Side::kOutput) +
                             identify::NominalInertia(model, effects::Side::kMotor);
      return edge > 0.0 ? inertia / (edge * edge) : 0.0;
    }
    case Smallest::kCounts:
      return DryFriction(model);
    case Smallest::kRounding: {
      const double counts = model.constants.encoder_counts_per_turn;
      const double rms = std::sqrt(column.squaredNorm() /
                                   std::max<double>(1.0, static_cast<double>(column.size())));
      return counts > 0.0 && rms > 0.0 ? kGivingCounts * 2.0 * std::numbers::pi / counts / rms
                                       : 0.0;
    }
    default:
      return 0.0;
  }
}

bool Provides(const identify::Design& design, const EffectInfo& info) {
  for (const std::string& field : info.needs) {
    if (!design.states().measured.contains(field)) return false;
  }
  return true;
}

}  // namespace

double DryFriction(const actuator::JointModel& model) {
  const int coulomb = model.Find("coulomb", model.balance);
  return coulomb < 0
             ? 0.0
             : std::abs(model.terms[static_cast<std::size_t>(coulomb)].linear.front().value);
}

double GivingLength(const effects::JointConstants& constants) {
  const double counts = constants.encoder_counts_per_turn;
  return counts > 0.0 ? kFewCounts * 2.0 * std::numbers::pi / counts : 0.0;
}

Nuisances MakeNuisances(const identify::Design& design, const UsedRows& used,
                        const actuator::JointModel& model,
                        const std::vector<std::string>& left_out) {
  Nuisances out;
  std::vector<Eigen::VectorXd> columns;
  std::vector<double> spread;
  for (const auto& [name, balance] : effects::EffectForms()) {
    if (balance != model.balance || model.Find(name, balance) >= 0) continue;
    if (std::find(left_out.begin(), left_out.end(), name) != left_out.end()) continue;
    const auto effect = effects::MakeEffect(name, model.constants, balance);
    const EffectInfo& info = effect->info();
    if (info.smallest == Smallest::kAny || info.linear.size() != 1 || !Provides(design, info)) {
      continue;
    }
    std::vector<double> psi;
    for (const effects::ParameterInfo& parameter : info.nonlinear) {
      psi.push_back(parameter.default_value);
    }
    if (info.smallest == Smallest::kCounts) {
      psi = {GivingLength(model.constants)};
      if (!(psi.front() > 0.0)) continue;
    }
    const Eigen::VectorXd column = -design.Columns(*effect, psi).col(0)(used.rows);
    const double own = Spread(design, model, info, column);
    if (!(own > 0.0) || !column.allFinite()) continue;
    out.names.push_back(name);
    columns.push_back(column);
    spread.push_back(own);
  }
  const bool refit = model.balance == effects::Balance::kMotion &&
                     std::find(left_out.begin(), left_out.end(), kRigidBodies) == left_out.end();
  const identify::StateSet& states = design.states();
  const auto count = static_cast<Eigen::Index>(columns.size());
  const Eigen::Index rigid = refit ? states.rigid_spread.size() : 0;
  out.columns.resize(used.size(), count + rigid);
  out.mean = Eigen::VectorXd::Zero(count + rigid);
  out.spread.resize(count + rigid);
  for (Eigen::Index k = 0; k < count; ++k) {
    out.columns.col(k) = columns[static_cast<std::size_t>(k)];
    out.spread[k] = spread[static_cast<std::size_t>(k)];
  }
  if (rigid > 0) {
    out.columns.rightCols(rigid) = used.Of(design.RigidColumns());
    out.mean.tail(rigid) = states.rigid_mean;
    out.spread.tail(rigid) = states.rigid_spread;
  }
  return out;
}

}  // namespace sinew::trace
