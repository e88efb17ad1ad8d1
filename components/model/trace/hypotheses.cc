#include "components/model/trace/hypotheses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include "components/model/identify/statistics.h"
#include "components/model/trace/machine_size.h"
#include "components/model/trace/nuisances.h"
#include "components/model/trace/order_spectrum.h"

namespace sinew::trace {

namespace {

using effects::EffectInfo;
using identify::Rms;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Lines of one effect that are looked for, and the share of the first one's gain that each needs:
// an imperfect model leaves many. What is left of a map of held positions is noise: all lines
// count.
constexpr int kMostLines = 8, kMostLinesOfMap = 24;
constexpr double kLeastLine = 0.02;
// Cogging repeats with the common multiples of slots and poles: no machine has fewer than 4 a turn.
// What comes once to three times a turn belongs to the shaft and its wheel.
constexpr double kLowestCogging = 3.5;
constexpr double kHighestOrder = 400.0;
// A line is worth looking at when noise alone would show one as strong among all independent orders
// in fewer than one of a thousand recordings: chi^2 with two degrees of freedom.
constexpr double kRarest = 1e-3;
// Gain of a free order over the true one by chance: chi^2 with one degree of freedom, 95 %.
constexpr double kFreeOrder = 3.84;
// Least travel, in turns, from which an order is known to be whole: a map ends one step before one
// turn.
constexpr double kWholeTurn = 0.51;

// Less of a wave than this is any smooth curve: it is no effect to search for, but may be what an
// effect over the angle really is. So are waves of a few periods per turn that no wheel turns by.
constexpr double kLeastPeriods = 1.0;
// Fewer of a line are a smooth curve over the whole range.
constexpr double kPeriodsOfLine = 3.0;
constexpr const char* kWave = "gear_eccentricity";
constexpr double kWaves[] = {1.0, 2.0, 3.0, 4.0};

// Settings of one effect that are asked for beside others: those of a resonance lie closer than
// its shape differs, so the loudest stand for the rest.
constexpr std::size_t kMostSettings = 12;

// Prior standard deviation of a coefficient over that with which its column alone would reach the
// highest torque that was seen: effects that cancel each other in part are larger than their sum.
constexpr double kTimesSeen = 3.0;

class Builder {
 public:
  Builder(const identify::Design& design, const Likelihood& likelihood,
          const actuator::JointModel& model, const identify::Balance& balance, Bank* bank)
      : design_(design),
        likelihood_(likelihood),
        model_(model),
        used_(likelihood.used),
        bank_(*bank) {
    scale_ = balance.Unit(balance.nominal);
    drive_share_ = actuator::DriveShare(model, model.balance);
    const Eigen::VectorXd angle =
        design.Variable([](const effects::JointSample& x) { return x.position_rad; });
    turns_ = TurnsCovered(angle(used_.rows));
    target_rms_ = Rms(bank_.target);
    target_peak_ = bank_.target.size() > 0 ? bank_.target.cwiseAbs().maxCoeff() : 0.0;
    if (model.balance == effects::Balance::kMotion && !design.held()) {
      machine_ = SizeOf(design, used_, model);
    }
  }

  void AddEffect(const Candidate& candidate) {
    const int family = NextFamily();
    for (const std::size_t k : Loudest(candidate)) {
      const GridPoint& point = candidate.grid[k];
      if (!CoversPeriod(*candidate.effect, point.psi)) continue;
      AddPoint(candidate, point, family);
    }
  }

  // Waves over the output's angle that are not searched for.
  void AddWaves(const Candidate& candidate) {
    const int family = NextFamily();
    for (const double order : kWaves) {
      const bool searched =
          ShowsPeriods(order, turns_) &&
          std::any_of(candidate.grid.begin(), candidate.grid.end(),
                      [&](const GridPoint& point) { return point.psi.front() == order; });
      if (searched) continue;
      const std::vector<double> psi = {order};
      if (AddPoint(candidate, {psi, design_.Columns(*candidate.effect, psi)}, family)) {
        bank_.hypotheses.back().asked = Asked::kRival;
      }
    }
  }

  bool AddPoint(const Candidate& candidate, const GridPoint& point, int family) {
    Hypothesis h;
    h.name = candidate.name();
    h.variable = candidate.effect->info().variable;
    h.effect = candidate.effect;
    if (candidate.stated) h.asked = Asked::kNoise;
    h.family = family;
    AddSetting(point.psi, point.columns, &h);
    h.charge = candidate.grid.size() > 1 ? kChargePerShape : 0.0;
    if (h.columns.empty()) return false;
    bank_.hypotheses.push_back(std::move(h));
    return true;
  }

  void AddEvent(const TimedEffect& event) {
    Candidate candidate;
    candidate.effect = event.effect;
    candidate.grid.push_back({event.Psi(), design_.Columns(*event.effect, event.Psi())});
    AddEffect(candidate);
    bank_.hypotheses.back().charge += event.charge;
  }

  void AddSetting(const std::vector<double>& psi, const Eigen::MatrixXd& phi, Hypothesis* h) {
    const Columns columns = AddColumns(-used_.Of(phi));
    const EffectInfo& info = h->effect->info();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const effects::ParameterInfo& parameter = info.linear[i];
      const double unit = std::abs(parameter.relative_to_drive ? scale_ / drive_share_ : scale_);
      // An effect much stronger than what the machine was seen to do is not to be expected.
      const double peak = bank_.columns.col(columns[i]).cwiseAbs().maxCoeff();
      double seen = peak > 0.0 ? target_peak_ / peak : 0.0;
      // A torque needs no column to be compared with it: friction of which the used rows are too
      // fast to see more than a trace is no larger, either.
      if (parameter.dimension == effects::Dimension::kTorque) seen = std::min(seen, target_peak_);
      double& spread = bank_.spread[columns[i]];
      spread = std::min(spread, kTimesSeen * seen);
      if (machine_ && !info.event) {
        spread = std::min(spread, ExpectedSize(parameter, *machine_, model_.constants) / unit);
      }
      const Range range = RangeOfAddition(design_, model_, *h->effect, psi, i);
      h->lower.push_back(std::min(range.lower, 0.0) / unit);
      h->upper.push_back(std::max(range.upper, 0.0) / unit);
      if (!info.follows_record) continue;
      // The drive's rate counts over the delay itself, within a factor of two; without a span up to
      // half a period of the fastest motion that the angles show.
      const double span_s = psi.front(), short_s = 0.5 / design_.options().state_cutoff_Hz;
      h->lower.back() = (span_s == 0.0 ? -short_s : 0.5 * span_s) / unit;
      h->upper.back() = (span_s == 0.0 ? short_s : 2.0 * span_s) / unit;
    }
    h->columns.insert(h->columns.end(), columns.begin(), columns.end());
    h->settings.push_back({psi, columns});
  }

  void AddCurve(const std::string& name, const std::string& variable, double order,
                const Eigen::MatrixXd& columns, double charge) {
    Hypothesis h;
    h.name = name;
    h.variable = variable;
    h.order_per_turn = order;
    h.family = NextFamily();
    h.columns = AddColumns(columns);
    h.charge = charge;
    h.lower.assign(h.columns.size(), -kInfinity);
    h.upper.assign(h.columns.size(), kInfinity);
    bank_.hypotheses.push_back(std::move(h));
  }

  void Finish() { bank_.columns.conservativeResize(used_.size(), filled_); }

  int NextFamily() const {
    int last = -1;
    for (const Hypothesis& h : bank_.hypotheses) last = std::max(last, h.family);
    return last + 1;
  }

 private:
  // The settings that gain most beside the declared terms, in their order.
  std::vector<std::size_t> Loudest(const Candidate& candidate) const {
    std::vector<std::size_t> out(candidate.grid.size());
    std::iota(out.begin(), out.end(), std::size_t{0});
    if (out.size() <= kMostSettings) return out;
    const Eigen::MatrixXd X = Whiten(likelihood_, bank_.declared);
    const Eigen::VectorXd y = Whiten(likelihood_, bank_.target);
    std::vector<double> gain;
    for (const GridPoint& point : candidate.grid) {
      const Eigen::MatrixXd z = Whiten(likelihood_, used_.Of(point.columns));
      Columns all(static_cast<std::size_t>(z.cols()));
      std::iota(all.begin(), all.end(), Eigen::Index{0});
      gain.push_back(Evidence(X, bank_.prior, z, Eigen::VectorXd::Zero(z.cols()), y).Gain(all));
    }
    std::stable_sort(out.begin(), out.end(),
                     [&](std::size_t a, std::size_t b) { return gain[a] > gain[b]; });
    out.resize(kMostSettings);
    std::sort(out.begin(), out.end());
    return out;
  }

  bool CoversPeriod(const effects::Effect& effect, const std::vector<double>& psi) const {
    return effect.info().name != kWave || ShowsPeriods(psi.front(), turns_);
  }

  Columns AddColumns(const Eigen::MatrixXd& columns) {
    Columns out;
    const Eigen::Index before = filled_;
    filled_ += columns.cols();
    if (filled_ > bank_.columns.cols()) {  // to twice as many: Finish takes back what is unused
      bank_.columns.conservativeResize(used_.size(), 2 * filled_);
    }
    bank_.spread.conservativeResize(filled_);
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      bank_.columns.col(before + c) = columns.col(c);
      const double rms = Rms(columns.col(c));
      bank_.spread[before + c] = rms > 0.0 ? kPlausibleShare * target_rms_ / rms : 0.0;
      out.push_back(before + c);
    }
    return out;
  }

  const identify::Design& design_;
  const Likelihood& likelihood_;
  const actuator::JointModel& model_;  // as declared
  const UsedRows& used_;
  Bank& bank_;
  Eigen::Index filled_ = bank_.columns.cols();
  std::optional<MachineSize> machine_;  // of the motion's balance
  double scale_ = 1.0, drive_share_ = 1.0, target_rms_ = 0.0, target_peak_ = 0.0;
  double turns_ = 0.0;  // of the output that the rows cover
};

// Is one a multiple of the other, as well as both are known?
bool IsHarmonic(double order, double first, double resolution) {
  const auto [low, high] = std::minmax(order, first);
  const double times = std::round(high / low);
  return times >= 2.0 && std::abs(high - times * low) < resolution * times;
}

// An angle known to sigma shows a line of order n damped by exp(-(n sigma)^2 / 2).
double HighestOrder(const actuator::JointModel& model) {
  const double counts = model.constants.encoder_counts_per_turn;
  const double sigma = counts > 0.0 ? 2.0 * std::numbers::pi / counts / std::sqrt(12.0) : 0.0;
  return sigma > 0.0 ? std::min(kHighestOrder, 1.0 / sigma) : kHighestOrder;
}

// A further line beside those found.
struct Line {
  std::vector<double> psi;
  Eigen::MatrixXd phi, found;  // of all rows; of all lines, whitened
  Eigen::VectorXd rest;
};

Line LineOf(double order, const Eigen::MatrixXd& phi, const Likelihood& likelihood,
            const Eigen::VectorXd& whitened_residual, const Eigen::MatrixXd& before) {
  Line out{.psi = {order}, .phi = phi, .found = before, .rest = {}};
  out.found.conservativeResize(likelihood.used.size(), before.cols() + 2);
  out.found.rightCols(2) = Whiten(likelihood, -likelihood.used.Of(phi));
  const Eigen::VectorXd c =
      (out.found.transpose() * out.found).ldlt().solve(out.found.transpose() * whitened_residual);
  out.rest = whitened_residual - out.found * c;
  return out;
}

}  // namespace

bool Hypothesis::follows_rates() const {
  static const std::set<std::string> kRates = {"acceleration_rad_s2", "motor_acceleration_rad_s2",
                                               "jerk_rad_s3", "snap_rad_s4", "drive_rate"};
  return kRates.contains(variable);
}

bool Hypothesis::from_rates() const {
  return physical() && effect->info().balance == effects::Balance::kMotion && follows_rates();
}

bool ShowsPeriods(double order, double turns) {
  return order * turns >= (order > 2.0 ? kPeriodsOfLine : kLeastPeriods);
}

const Rule& RuleOfShare(const Hypothesis& hypothesis) {
  return hypothesis.from_rates() && !hypothesis.steady ? rules::kCurveShare
                                                       : rules::kExplainedShare;
}

double LeastVariance(const Hypothesis& hypothesis, const InForce& in_force) {
  const double more = RuleOfShare(hypothesis).limit / rules::kExplainedShare.limit;
  return more * in_force.Limit(rules::kVarianceShare);
}

Bank MakeBank(const identify::Design& design, const Likelihood& likelihood,
              const actuator::JointModel& model, const identify::Balance& balance) {
  const UsedRows& used = likelihood.used;
  Bank bank;
  bank.in_force = likelihood.in_force;
  bank.target = balance.target(used.rows);
  bank.parameters = balance.columns.cols();
  bank.columns.resize(used.size(), 0);

  const Nuisances nuisances = MakeNuisances(design, likelihood, model);
  const Eigen::Index extra = nuisances.columns.cols();
  bank.declared.resize(used.size(), bank.parameters + extra);
  bank.declared << used.Of(balance.columns), nuisances.columns;
  bank.prior = PriorOf(balance, model, used, nuisances);

  Builder builder(design, likelihood, model, balance, &bank);
  const bool spectrum = design.states().measured.contains("motor_position_rad");
  CandidateSet set = MakeCandidates(design, model, likelihood.in_force);
  for (const Candidate& candidate : set.candidates) {
    if (spectrum && candidate.name() == "cogging") continue;  // AddOrders
    builder.AddEffect(candidate);
    if (candidate.name() == kWave) builder.AddWaves(candidate);
  }
  if (likelihood.event) builder.AddEvent(*likelihood.event);
  for (const Curve& curve : FreeCurves(design, model.balance)) {
    builder.AddCurve(curve.description, curve.variable, 0.0, used.Of(curve.columns), 0.0);
  }
  builder.Finish();
  bank.untestable = std::move(set.untestable);
  return bank;
}

void AddOrders(const identify::Design& design, const Likelihood& likelihood,
               const actuator::JointModel& model, const identify::Balance& balance,
               const Eigen::VectorXd& whitened_residual, Bank* bank) {
  const UsedRows& used = likelihood.used;
  if (!design.states().measured.contains("motor_position_rad")) return;
  if (model.balance != effects::Balance::kMotion) return;
  const Eigen::VectorXd angle = design.Variable(
      [](const effects::JointSample& x) { return x.motor_position_rad; })(used.rows);
  const double turns = TurnsCovered(angle);
  if (!(turns > 0.0)) return;
  double highest = HighestOrder(model);
  // Holds stand at even steps of the angle: faster lines look like slower ones.
  if (design.held()) highest = std::min(highest, 0.5 * static_cast<double>(used.size()) / turns);
  const double lowest = std::max(0.5, kPeriodsOfLine / turns);
  if (!(highest > lowest)) return;
  const double independent = IndependentOrders(turns, lowest, highest);
  const double limit = 2.0 * std::log(independent / kRarest);

  Builder builder(design, likelihood, model, balance, bank);
  const Eigen::VectorXd speed = design.Variable(
      [](const effects::JointSample& x) { return std::abs(x.motor_velocity_rad_s); })(used.rows);
  const double band_rad_s = 2.0 * std::numbers::pi * design.options().state_cutoff_Hz;
  Eigen::VectorXd e = whitened_residual;
  Hypothesis cogging;
  cogging.name = "cogging";
  cogging.effect = effects::MakeEffect("cogging", model.constants, effects::Balance::kMotion);
  cogging.variable = cogging.effect->info().variable;
  const auto line_of = [&](double order, const Eigen::MatrixXd& before) {
    return LineOf(order, design.Columns(*cogging.effect, {&order, 1}), likelihood,
                  whitened_residual, before);
  };
  Eigen::MatrixXd found(used.size(), 0);
  std::vector<double> known;
  double first = 0.0;
  const int most = design.held() ? kMostLinesOfMap : kMostLines;
  const double least = design.held() ? 0.0 : kLeastLine;
  const double resolution = 0.5 / turns;
  for (int k = 0; k < most; ++k) {
    const Eigen::VectorXd g = WhitenTransposed(likelihood, e);
    const OrderLine strongest =
        design.held() ? StrongestOrder(g, angle, lowest, highest, known)
                      : StrongestRipple(g, angle, speed, band_rad_s, lowest, highest, known);
    if (!(strongest.order > 0.0)) break;
    Line line = line_of(strongest.order, found);
    // A whole order is that order: within the resolution, or where the nearest whole one leaves no
    // more than chance would (rows that are slow enough may cover less than all turns).
    const double whole_order = std::round(strongest.order);
    bool integer = whole_order >= 1.0 && std::abs(strongest.order - whole_order) < resolution;
    if (whole_order >= 1.0 && resolution < kWholeTurn) {
      Line whole = line_of(whole_order, found);
      integer = integer || whole.rest.squaredNorm() < line.rest.squaredNorm() + kFreeOrder;
      if (integer) line = std::move(whole);
    }
    const double gain = e.squaredNorm() - line.rest.squaredNorm();
    if (!(gain > limit) || (k > 0 && gain < least * first)) break;
    if (k == 0) first = gain;
    e = line.rest;
    found = line.found;
    known.push_back(line.psi.front());
    // On a part of a turn every line could be of a whole order, those of a bump as well.
    if (integer && resolution >= kWholeTurn && !cogging.settings.empty()) {
      integer = IsHarmonic(line.psi.front(), cogging.settings.front().psi.front(), resolution);
    }
    const double charge = limit - 2.0 * std::log(1.0 / kRarest);
    if (integer && line.psi.front() > kLowestCogging) {
      builder.AddSetting(line.psi, line.phi, &cogging);
      cogging.charge += charge;
    } else if (!integer) {
      builder.AddCurve("line of the motor's angle", "motor_position_rad", line.psi.front(),
                       -used.Of(line.phi), charge);
    }
  }
  builder.Finish();
  if (!cogging.settings.empty()) {
    cogging.family = builder.NextFamily();
    cogging.order_per_turn = cogging.settings.front().psi.front();
    bank->hypotheses.push_back(std::move(cogging));
  }
}

}  // namespace sinew::trace
