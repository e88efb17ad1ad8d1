#include "components/model/trace/nuisances.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "components/model/identify/gas.h"
#include "components/model/trace/machine_size.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

namespace {

using effects::EffectInfo;
using effects::Smallest;

// Half of what an opening may take (gas.h) as one standard deviation.
constexpr double kOpeningSpread = 0.5 * identify::kOpeningSamples;
// Teeth, bearings and the encoder's own mounting give: counts of the encoder at the torque's rms.
constexpr double kGivingCounts = 1.0;

// Delay between drive and angles that any recording has.
constexpr double kLeastLag_s = 0.3e-3, kLagSamples = 0.03;

// Every contact yields a little before it slides: over some counts of the encoder.
constexpr double kFewCounts = 8.0;

// Teeth of a declared compliance twist by a torque that is known as well as the drive's scale.
double TwistError(const actuator::JointModel& model) {
  const int play = model.Find("free_play", effects::Balance::kKinematic);
  if (play < 0) return 0.0;
  double scale = 0.0;
  for (const actuator::Term& term : model.terms) {
    const EffectInfo& info = term.effect->info();
    if (info.role != effects::Role::kDrive || info.balance != effects::Balance::kMotion) continue;
    if (!term.linear.front().fixed) scale = actuator::RelativeSpread(term.linear.front());
  }
  return scale * std::abs(model.terms[static_cast<std::size_t>(play)].linear.back().value);
}

double Spread(const identify::Design& design, const actuator::JointModel& model,
              const EffectInfo& info, const Eigen::VectorXd& column) {
  const double period_s = 1.0 / design.states().rate_Hz;
  switch (info.smallest) {
    case Smallest::kTenthOfSample:
      return std::max(kLeastLag_s, kLagSamples * period_s);
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
      const double rounding =
          counts > 0.0 && rms > 0.0 ? kGivingCounts * 2.0 * std::numbers::pi / counts / rms : 0.0;
      return std::hypot(rounding, TwistError(model));
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

namespace {

// Spreads of a uniform within half a period either way: 1.72; of a normal one that is no accident.
constexpr double kMostUniform = 1.75, kMostNormal = 3.0;

// Nuisances as they are put together.
struct Collected {
  const std::vector<std::string>& left_out;
  std::vector<std::string> names;
  std::vector<Eigen::VectorXd> columns;
  std::vector<double> spread, most;

  bool LeavesOut(const std::string& name) const {
    return std::find(left_out.begin(), left_out.end(), name) != left_out.end();
  }
  void Add(std::string name, Eigen::VectorXd column, double own, double own_most = kMostNormal) {
    if (!(own > 0.0) || !column.allFinite() || !(column.squaredNorm() > 0.0)) return;
    if (LeavesOut(name)) return;
    names.push_back(std::move(name));
    columns.push_back(std::move(column));
    spread.push_back(own);
    most.push_back(own_most);
  }
};

double Sign(double x) { return static_cast<double>(x > 0.0) - static_cast<double>(x < 0.0); }

// Imperfections that no machine of this size is without, as standard deviations relative to it.
class OfMachine {
 public:
  OfMachine(const identify::Design& design, const UsedRows& used, const actuator::JointModel& model)
      : design_(design), used_(used), model_(model), size_(SizeOf(design, used, model)) {
    for (const Eigen::Index row : used.rows) {
      const double time_s = design.rows().time_s[row];
      auto [at, fresh] = span_.try_emplace(design.rows().RunOf(row), time_s, time_s);
      at->second.first = std::min(at->second.first, time_s);
      at->second.second = std::max(at->second.second, time_s);
    }
  }

  void AddTo(Collected* out) const {
    const Eigen::VectorXd drive =
        size_.drive_gain * Of([](const effects::JointSample& x) { return x.drive_input; });
    const double level = kLevel * size_.drive_rms;
    const Eigen::VectorXd side =
        Of([](const effects::JointSample& x) { return Sign(x.velocity_rad_s); });
    for (const auto& [run, span] : span_) {
      const Eigen::VectorXd one = InRun(run, false), time = InRun(run, true);
      const std::string name = design_.states().run_names.at(run);
      out->Add("level of " + name, one, level);
      out->Add("drift of " + name, time, level);
      out->Add("friction over time of " + name, side.cwiseProduct(time),
               kFrictionDrift * size_.friction);
    }
    AddBristles(out);
    const Eigen::VectorXd v = Of([](const effects::JointSample& x) { return x.velocity_rad_s; });
    if (size_.quick > 0.0) {
      out->Add("bent viscous", v.cwiseProduct(v.cwiseAbs()) / size_.quick, kBent * size_.viscous);
    }
    if (size_.drive_peak > 0.0) {
      out->Add("mesh", side.cwiseProduct(drive.cwiseAbs()),
               std::max(kMesh, kMeshFriction * size_.friction / size_.drive_peak));
    }
    if (model_.kind == types::JointKind::kRevolute) {
      out->Add("tilt", Of([](const effects::JointSample& x) { return std::sin(x.position_rad); }),
               kTilt_rad * size_.gravity);
    }
  }

 private:
  static constexpr double kLevel = 0.0012;        // of the drive's rms
  static constexpr double kFrictionDrift = 0.01;  // of the dry friction
  // Lengths, share of the stroke.
  static constexpr std::pair<const char*, double> kBristles[] = {{"short bristles", 0.0005},
                                                                 {"bristles", 0.0015}};
  static constexpr double kBristleFriction = 0.5;  // of the dry friction
  static constexpr double kBent = 0.02;
  static constexpr double kMesh = 0.003, kMeshFriction = 0.03;
  static constexpr double kTilt_rad = 4e-3;

  template <class Function>
  Eigen::VectorXd Of(Function f) const {
    return design_.Column(f)(used_.rows);
  }

  // 1, or the time from -1 to 1, in one recording.
  Eigen::VectorXd InRun(std::size_t run, bool time) const {
    const auto [first, last] = span_.at(run);
    Eigen::VectorXd out = Eigen::VectorXd::Zero(used_.size());
    for (Eigen::Index k = 0; k < used_.size(); ++k) {
      const Eigen::Index row = used_.rows[static_cast<std::size_t>(k)];
      if (design_.rows().RunOf(row) != run) continue;
      out[k] = !time          ? 1.0
               : last > first ? 2.0 * (design_.rows().time_s[row] - first) / (last - first) - 1.0
                              : 0.0;
    }
    return out;
  }

  void AddBristles(Collected* out) const {
    const Eigen::VectorXd q = Of([](const effects::JointSample& x) { return x.position_rad; });
    const double stroke = q.size() > 0 ? q.maxCoeff() - q.minCoeff() : 0.0;
    const auto effect = effects::MakeEffect("presliding", model_.constants);
    for (const auto& [name, share] : kBristles) {
      const std::vector<double> psi = {share * stroke};
      if (!(psi.front() > 0.0)) continue;
      out->Add(name, -design_.Columns(*effect, psi).col(0)(used_.rows),
               kBristleFriction * size_.friction);
    }
  }

  const identify::Design& design_;
  const UsedRows& used_;
  const actuator::JointModel& model_;
  MachineSize size_;
  std::map<std::size_t, std::pair<double, double>> span_;  // of the used rows, s
};

}  // namespace

Nuisances MakeNuisances(const identify::Design& design, const Likelihood& likelihood,
                        const actuator::JointModel& model) {
  const UsedRows& used = likelihood.used;
  Nuisances out;
  Collected found{likelihood.no_nuisance, {}, {}, {}, {}};
  for (const auto& [name, balance] : effects::EffectForms()) {
    if (balance != model.balance || model.Find(name, balance) >= 0) continue;
    if (found.LeavesOut(name)) continue;
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
    found.Add(name, column, Spread(design, model, info, column), kMostUniform);
  }
  if (model.balance == effects::Balance::kMotion && !design.held()) {
    OfMachine(design, used, model).AddTo(&found);
  }
  const bool refit = model.balance == effects::Balance::kMotion && !found.LeavesOut(kRigidBodies);
  const identify::StateSet& states = design.states();
  out.names = found.names;
  out.most = found.most;
  const auto count = static_cast<Eigen::Index>(found.columns.size());
  const Eigen::Index rigid = refit ? states.rigid_spread.size() : 0;
  out.columns.resize(used.size(), count + rigid);
  out.mean = Eigen::VectorXd::Zero(count + rigid);
  out.spread.resize(count + rigid);
  for (Eigen::Index k = 0; k < count; ++k) {
    out.columns.col(k) = found.columns[static_cast<std::size_t>(k)];
    out.spread[k] = found.spread[static_cast<std::size_t>(k)];
  }
  if (rigid > 0) {
    out.columns.rightCols(rigid) = used.Of(design.RigidColumns());
    out.mean.tail(rigid) = states.rigid_mean;
    out.spread.tail(rigid) = states.rigid_spread;
  }
  return out;
}

}  // namespace sinew::trace
