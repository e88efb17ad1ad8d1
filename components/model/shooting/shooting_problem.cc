#include "components/model/shooting/shooting_problem.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/model/identify/statistics.h"
#include "components/model/trace/candidates.h"
#include "components/model/trace/machine_size.h"
#include "components/model/trace/set_search.h"
#include "components/model/trace/used_rows.h"

namespace sinew::shooting {

namespace {

using effects::JointSample;
using trace::Hypothesis;

// Small coefficient of an effect: share of the machine's friction.
constexpr double kEffectShare = 0.3;
// Settings of an effect, even over its grid: each costs a simulation of all recordings.
constexpr std::size_t kMostSettings = 12;
// Prior of a coefficient over that with which it alone would be the highest torque (hypotheses.cc).
constexpr double kTimesSeen = 3.0;
constexpr int kKnots = 8;
// Least share of the largest eigenvalue of X'X that is no error of the differences.
constexpr double kLeastSeen = 1e-10;

// Torque as hats over a signal, times the direction of motion or not: a free curve.
class HatCurve final : public effects::Effect {
 public:
  using Getter = double (*)(const JointSample&);
  HatCurve(const char* variable, Getter get, bool by_direction, std::vector<double> knots)
      : Effect(InfoOf(variable, by_direction, knots.size())),
        get_(get),
        by_direction_(by_direction),
        knots_(std::move(knots)) {}
  void Regressors(const JointSample& x, std::span<const double>, std::span<const double>,
                  std::span<double> phi) const noexcept override {
    const double v = std::clamp(get_(x), knots_.front(), knots_.back());
    const double side = !by_direction_ ? 1.0 : x.velocity_rad_s < 0.0 ? -1.0 : 1.0;
    std::fill(phi.begin(), phi.end(), 0.0);
    const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, v);
    const auto k = static_cast<std::size_t>(above - knots_.begin());
    const double share = (v - knots_[k - 1]) / (knots_[k] - knots_[k - 1]);
    phi[k] = side * share;
    phi[k - 1] = side * (1.0 - share);
  }

 private:
  static effects::EffectInfo InfoOf(const char* variable, bool by_direction, std::size_t knots) {
    effects::EffectInfo info;
    info.name = "curve";
    info.needs = {variable};
    if (by_direction) info.needs.emplace_back("velocity_rad_s");
    info.linear.resize(knots);
    return info;
  }

  Getter get_;
  bool by_direction_;
  std::vector<double> knots_;
};

std::vector<double> Knots(const Eigen::VectorXd& values) {
  std::vector<double> sorted(values.begin(), values.end()), knots;
  std::sort(sorted.begin(), sorted.end());
  const double span = sorted.back() - sorted.front();
  for (int k = 0; k < kKnots; ++k) {
    const double value = sorted[static_cast<std::size_t>(k) * (sorted.size() - 1) / (kKnots - 1)];
    if (knots.empty() || value > knots.back() + 1e-3 * span) knots.push_back(value);
  }
  return knots;
}

class Builder {
 public:
  Builder(const Recordings& recordings, const Fit& fit, const std::vector<Parameter>& parameters)
      : recordings_(recordings), fit_(fit), machine_(recordings.machine()) {
    out_.parameters = parameters;
    out_.bank.parameters = static_cast<Eigen::Index>(parameters.size());
    base_ = recordings.Stacked(fit.model, fit.start);
    out_.target = -base_;
    out_.target.head(recordings.rows()) += recordings.measured();
    torque_ = std::max(machine_.friction, 1e-9);
    const Eigen::VectorXd& q = recordings.measured();
    out_.measured_rms = identify::Rms(q.array() - q.mean());
    out_.torque_peak = std::max({machine_.drive_peak, machine_.gravity, machine_.friction});
  }

  Regression Build(const trace::InForce* search) {
    AddDeclared();
    if (search != nullptr) {
      out_.bank.in_force = *search;
      AddEffects();
      AddCurves();
    }
    AddBlocks();
    const Eigen::Index angles = recordings_.rows();
    out_.declared = Joined(declared_);
    out_.columns = Joined(columns_);
    out_.bank.declared = out_.declared.topRows(angles);
    out_.bank.columns = out_.columns.topRows(angles);
    out_.bank.target = out_.target.head(angles);
    out_.bank.prior.mean = Vector(mean_);
    out_.bank.prior.precision = Vector(precision_);
    out_.bank.spread = Vector(spread_);
    return std::move(out_);
  }

 private:
  static Eigen::VectorXd Vector(const std::vector<double>& values) {
    return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                             static_cast<Eigen::Index>(values.size()));
  }
  Eigen::MatrixXd Joined(const std::vector<Eigen::VectorXd>& columns) const {
    Eigen::MatrixXd out(base_.size(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c)
      out.col(static_cast<Eigen::Index>(c)) = columns[c];
    return out;
  }

  void Declare(Eigen::VectorXd column, double mean, double precision) {
    declared_.push_back(std::move(column));
    mean_.push_back(mean);
    precision_.push_back(precision);
  }

  // Coefficients are changes from the fit.
  void AddDeclared() {
    for (const Parameter& p : out_.parameters) {
      actuator::JointModel model = fit_.model;
      double& value = ValueOf(p, &model);
      const double fitted = value, step = kCentralDifference * p.scale;
      value = fitted + step;
      const Eigen::VectorXd above = recordings_.Stacked(model, fit_.start);
      value = fitted - step;
      Declare((above - recordings_.Stacked(model, fit_.start)) / (2.0 * kCentralDifference),
              (p.mean - fitted) / p.scale, p.precision);
    }
    for (Eigen::Index r = 0; r < fit_.start.zero_rad.size(); ++r) {
      const double deviation = recordings_.zero_deviation()[r];
      if (!(deviation > 0.0)) continue;
      Start start = fit_.start;
      start.zero_rad[r] += kDifference * deviation;
      Declare((recordings_.Stacked(fit_.model, start) - base_) / kDifference,
              -fit_.start.zero_rad[r] / deviation, 1.0);
    }
    Eigen::Index gap = recordings_.rows();  // first row of the piece's gap
    for (std::size_t p = 0; p < recordings_.pieces().size(); ++p) {
      const Piece& piece = recordings_.pieces()[p];
      const bool continued = p > 0 && recordings_.pieces()[p - 1].continues;
      for (Eigen::Index k = 0; k < recordings_.deviation().size(); ++k) {
        Eigen::VectorXd column = StateColumn(p, k, gap);
        if (continued && k < 2) column[gap - 2 + k] = -1.0;
        Declare(std::move(column), -fit_.start.state(k, static_cast<Eigen::Index>(p)), 1.0);
      }
      if (piece.continues) gap += 2;
    }
  }

  // Only one piece moves.
  Eigen::VectorXd StateColumn(std::size_t p, Eigen::Index k, Eigen::Index gap) const {
    const Piece& piece = recordings_.pieces()[p];
    const auto c = static_cast<Eigen::Index>(p);
    Eigen::VectorXd state = fit_.start.state.col(c);
    state[k] += kDifference;
    const Path path = recordings_.Simulate(fit_.model, p, state, fit_.start.zero_rad[piece.run]);
    Eigen::VectorXd column = Eigen::VectorXd::Zero(base_.size());
    column.segment(piece.row, piece.count) =
        (path.angle - base_.segment(piece.row, piece.count)) / kDifference;
    if (piece.continues) {
      column.segment<2>(gap) =
          (recordings_.Gap(p, path, fit_.start.state.col(c + 1)) - base_.segment<2>(gap)) /
          kDifference;
    }
    return column;
  }

  // Columns of an effect with one setting; nothing where it cannot be simulated or shows nowhere.
  // torques: its phi along the measured motion.
  bool AddTerm(const actuator::Term& term, const Eigen::MatrixXd& torques, Hypothesis* h) {
    std::vector<Eigen::VectorXd> columns;
    std::vector<double> spreads;
    const effects::EffectInfo& info = term.effect->info();
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      const auto c = static_cast<Eigen::Index>(i);
      const double rms = identify::Rms(torques.col(c));
      const double peak = torques.col(c).cwiseAbs().maxCoeff();
      if (!(rms > 0.0)) {
        columns.emplace_back(Eigen::VectorXd::Zero(base_.size()));
        spreads.push_back(0.0);
        continue;
      }
      const double size = kEffectShare * torque_ / rms;
      actuator::JointModel model = fit_.model;
      model.terms.push_back(term);
      model.terms.back().linear[i].value = size;
      columns.push_back((recordings_.Stacked(model, fit_.start) - base_) / size);
      if (!columns.back().allFinite()) return false;
      const double expected =
          h->physical() ? trace::ExpectedSize(info.linear[i], machine_, fit_.model.constants)
                        : trace::kPlausibleShare * std::max(machine_.drive_rms, torque_) / rms;
      spreads.push_back(std::min(expected, kTimesSeen * out_.torque_peak / peak));
    }
    const bool shows = std::any_of(columns.begin(), columns.end(),
                                   [](const auto& column) { return column.squaredNorm() > 0.0; });
    if (!shows) return false;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      h->columns.push_back(static_cast<Eigen::Index>(columns_.size()));
      columns_.push_back(std::move(columns[i]));
      spread_.push_back(spreads[i]);
    }
    return true;
  }

  void AddEffects() {
    trace::CandidateSet set =
        trace::MakeCandidates(recordings_.design(), fit_.model, out_.bank.in_force);
    out_.bank.untestable = std::move(set.untestable);
    const double turns = Turns();
    for (const trace::Candidate& candidate : set.candidates) {
      const std::size_t count = std::min(candidate.grid.size(), kMostSettings);
      bool any = false;
      std::string why = "no part of it moves the joint in this motion";
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t at = k * candidate.grid.size() / count;
        try {
          any = AddSetting(candidate, candidate.grid[at], count, turns) || any;
        } catch (const std::invalid_argument& error) {
          why = std::string("cannot be simulated: ") + error.what();
        }
      }
      ++family_;
      if (!any && !candidate.stated) out_.bank.untestable.push_back({candidate.name(), why});
    }
  }

  bool AddSetting(const trace::Candidate& candidate, const trace::GridPoint& point,
                  std::size_t settings, double turns) {
    const effects::EffectInfo& info = candidate.effect->info();
    Hypothesis h;
    h.name = info.name;
    h.variable = info.variable;
    h.effect = candidate.effect;
    h.family = family_;
    h.charge = settings > 1 ? trace::kChargePerShape : 0.0;
    if (candidate.stated) h.asked = trace::Asked::kNoise;
    if (info.ripple && !trace::ShowsPeriods(point.psi.front(), turns)) {
      h.asked = trace::Asked::kRival;
    }
    actuator::Term term;
    term.effect = candidate.effect;
    term.declared = false;
    term.linear.resize(info.linear.size());
    for (const double psi : point.psi)
      term.nonlinear.push_back({.value = psi, .half_width_95 = {}});
    if (!AddTerm(term, point.columns, &h)) return false;
    while (h.lower.size() < info.linear.size()) {
      const trace::Range range = trace::RangeOfAddition(recordings_.design(), fit_.model,
                                                        *term.effect, point.psi, h.lower.size());
      h.lower.push_back(std::min(range.lower, 0.0));
      h.upper.push_back(std::max(range.upper, 0.0));
    }
    h.settings.push_back({point.psi, h.columns});
    out_.bank.hypotheses.push_back(std::move(h));
    return true;
  }

  double Turns() const {
    const Eigen::VectorXd& q = recordings_.measured();
    return (q.maxCoeff() - q.minCoeff()) / (2.0 * std::numbers::pi);
  }

  void AddCurves() {
    AddCurve(
        "position_rad", [](const JointSample& x) { return x.position_rad; }, false);
    AddCurve(
        "velocity_rad_s", [](const JointSample& x) { return x.velocity_rad_s; }, false);
    AddCurve(
        "drive_input", [](const JointSample& x) { return x.drive_input; }, true);
  }

  void AddCurve(const char* variable, HatCurve::Getter get, bool by_direction) {
    const std::vector<double> knots = Knots(recordings_.design().Variable(get));
    if (knots.size() < 3) return;
    actuator::Term term;
    const auto effect = std::make_shared<HatCurve>(variable, get, by_direction, knots);
    term.effect = effect;
    term.linear.resize(knots.size());
    Hypothesis h;
    h.name = std::string("curve over ") + variable + (by_direction ? " times the direction" : "");
    h.variable = variable;
    h.family = family_++;
    if (!AddTerm(term, recordings_.design().Columns(*effect, {}), &h)) return;
    h.lower.assign(h.columns.size(), -HUGE_VAL);
    h.upper.assign(h.columns.size(), HUGE_VAL);
    out_.bank.hypotheses.push_back(std::move(h));
  }

  // Whole pieces with their gaps, no more blocks than inference makes use of.
  void AddBlocks() {
    const std::vector<Piece>& pieces = recordings_.pieces();
    const std::size_t each = (pieces.size() + trace::kMostBlocks - 1) / trace::kMostBlocks;
    Eigen::Index gap = recordings_.rows();
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      out_.stretches.push_back({pieces[p].row, pieces[p].count});
      if (p % each == 0) out_.blocks.emplace_back();
      identify::Block& block = out_.blocks.back();
      for (Eigen::Index i = 0; i < pieces[p].count; ++i) block.push_back(pieces[p].row + i);
      for (int k = 0; pieces[p].continues && k < 2; ++k) block.push_back(gap++);
    }
    out_.block_s = recordings_.piece_s() * static_cast<double>(each);
  }

  const Recordings& recordings_;
  const Fit& fit_;
  const trace::MachineSize& machine_;
  double torque_ = 0.0;
  Eigen::VectorXd base_;
  std::vector<Eigen::VectorXd> declared_, columns_;
  std::vector<double> mean_, precision_, spread_;
  int family_ = 0;
  Regression out_;
};

}  // namespace

Regression MakeRegression(const Recordings& recordings, const Fit& fit,
                          const std::vector<Parameter>& parameters, const trace::InForce* search) {
  return Builder(recordings, fit, parameters).Build(search);
}

Eigen::MatrixXd Whiten(const Regression& regression, const Noise& noise,
                       const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  Eigen::MatrixXd out = columns / noise.gap;
  const Eigen::Index angles = regression.bank.target.size();
  out.topRows(angles) = noise.angle.Whiten(columns.topRows(angles), regression.stretches);
  return out;
}

Noise NoiseOf(const Regression& regression, const Recordings& recordings,
              const Eigen::Ref<const Eigen::VectorXd>& residual, bool coloured) {
  const Eigen::Index angles = recordings.rows();
  return {trace::NoiseModel(residual.head(angles), regression.stretches,
                            coloured ? trace::LongestOrder(recordings.design()) : 0),
          std::max(1.0, identify::Rms(residual.tail(residual.size() - angles)))};
}

trace::Problem MakeProblem(const Regression& regression, const Noise& noise) {
  const trace::Bank& bank = regression.bank;
  Eigen::MatrixXd X = Whiten(regression, noise, regression.declared);
  Eigen::MatrixXd Z = Whiten(regression, noise, regression.columns);
  Eigen::VectorXd y = Whiten(regression, noise, regression.target);
  const Eigen::VectorXd precision =
      (bank.spread.array() > 0.0).select(bank.spread.array().square().inverse(), 1e300);
  trace::Evidence evidence(X, bank.prior, Z, precision, y);
  trace::Problem out{bank, std::move(X), std::move(Z), std::move(y), 1.0, std::move(evidence), 0.0};
  out.variance = identify::LeftBy(bank.declared, bank.target).squaredNorm();
  out.measured_rms = regression.measured_rms;
  out.measured_peak = regression.torque_peak;
  return out;
}

trace::Problem ProblemWithNoise(const Regression& regression, const Recordings& recordings,
                                Noise* noise) {
  constexpr int kPasses = 3;
  *noise = NoiseOf(regression, recordings, regression.target, false);
  for (int pass = 1; pass <= kPasses; ++pass) {
    const trace::Problem problem = MakeProblem(regression, *noise);
    const trace::EffectSet set = trace::SearchSets(problem.choices(), 1).best.back();
    const Eigen::VectorXd rest =
        regression.target - regression.columns(Eigen::all, set.columns) * set.c -
        regression.declared * problem.evidence.Declared(set.columns, set.c);
    *noise = NoiseOf(regression, recordings, rest, pass == kPasses);
  }
  return MakeProblem(regression, *noise);
}

Eigen::VectorXd DeviationOf(const Regression& regression, const Noise& noise) {
  const Eigen::MatrixXd X = Whiten(regression, noise, regression.declared);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(X.transpose() * X);
  // A direction that only priors hold, as the scale of inertia and gravity in a free swing, keeps
  // its width: columns that are differences of simulations do not cancel any better.
  const Eigen::VectorXd seen =
      (eigen.eigenvalues().array() > kLeastSeen * eigen.eigenvalues().maxCoeff())
          .select(eigen.eigenvalues(), 0.0);
  Eigen::MatrixXd A = eigen.eigenvectors() * seen.asDiagonal() * eigen.eigenvectors().transpose();
  A.diagonal() += regression.bank.prior.precision;
  A.diagonal().array() += 1e-12;  // flat and not seen: any width
  const Eigen::MatrixXd covariance = A.ldlt().solve(Eigen::MatrixXd::Identity(A.rows(), A.cols()));
  Eigen::VectorXd out(regression.bank.parameters);
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    out[i] = std::sqrt(std::max(0.0, covariance(i, i))) *
             regression.parameters[static_cast<std::size_t>(i)].scale;
  }
  return out;
}

}  // namespace sinew::shooting
