#include "components/model/trace/facts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "components/base/types/angle.h"
#include "components/model/identify/statistics.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

namespace {

// A slope that cannot be assessed costs as much as one of 0.25: without the held-out recordings
// nothing is named.
constexpr double kUnassessed = 0.75;

constexpr double k95 = 1.96;  // standard deviations either way

// A held-out balance beside what training found, at its used rows.
class HeldOutBalance {
 public:
  HeldOutBalance(const Problem& problem, const identify::Design& design,
                 const identify::FitResult& declared_fit, const Likelihood& train)
      : problem_(problem), design_(design) {
    likelihood_.no_nuisance = train.no_nuisance;
    likelihood_.used = MakeUsedRows(design, kFewestRowsPerBlock);
    usable_ = used().size() >= kFewestRowsPerBlock;
    if (!usable_) return;
    const identify::Balance balance =
        identify::MakeBalance(design, declared_fit.model, declared_fit.balance.fits_scale);
    declared_ = used().Of(balance.columns);
    target_ = balance.target(used().rows);
  }

  bool usable() const { return usable_; }
  const Likelihood& likelihood() const { return likelihood_; }
  const UsedRows& used() const { return likelihood_.used; }

  // Columns of a hypothesis.
  Eigen::MatrixXd Columns(const Hypothesis& h) const {
    Eigen::MatrixXd out(used().size(), static_cast<Eigen::Index>(h.columns.size()));
    Eigen::Index at = 0;
    for (const TermSetting& setting : h.settings) {
      const Eigen::MatrixXd phi = -used().Of(design_.Columns(*h.effect, setting.psi));
      out.middleCols(at, phi.cols()) = phi;
      at += phi.cols();
    }
    return out;
  }

  // Residual with a set, its declared terms refitted in training. An event began elsewhere here.
  Eigen::VectorXd Left(const EffectSet& set) const {
    Eigen::VectorXd rest =
        target_ - declared_ * problem_.evidence.Declared(set.columns, set.c).head(declared_.cols());
    Eigen::Index at = 0;
    for (const std::size_t j : set.members) {
      const Hypothesis& h = problem_.hypotheses()[j];
      const auto columns = static_cast<Eigen::Index>(h.columns.size());
      if (!h.effect->info().event) rest -= Columns(h) * set.c.segment(at, columns);
      at += columns;
    }
    return rest;
  }

 private:
  const Problem& problem_;
  const identify::Design& design_;
  Likelihood likelihood_;
  bool usable_ = false;
  Eigen::MatrixXd declared_;
  Eigen::VectorXd target_;
};

// Coefficients of sines and cosines of the settings' orders, turned by an angle.
Eigen::VectorXd Turned(const Hypothesis& lines, const Eigen::VectorXd& c, double turn_rad) {
  Eigen::VectorXd out = c;
  Eigen::Index at = 0;
  for (const TermSetting& setting : lines.settings) {
    const double angle = setting.psi.front() * turn_rad;
    out[at] = c[at] * std::cos(angle) - c[at + 1] * std::sin(angle);
    out[at + 1] = c[at] * std::sin(angle) + c[at + 1] * std::cos(angle);
    at += 2;
  }
  return out;
}

// The turn at which columns * Turned(c) explains most of y, by more than `least`. Of turns that do
// equally well the smallest; 0: none.
double BestTurn(const Hypothesis& lines, const Eigen::VectorXd& c, const Eigen::MatrixXd& columns,
                const Eigen::VectorXd& y, double least) {
  constexpr double kStepsPerPeriod = 16.0;
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  const Eigen::VectorXd moment = columns.transpose() * y;
  const auto gain = [&](double turn_rad) {
    const Eigen::VectorXd turned = Turned(lines, c, turn_rad);
    return 2.0 * moment.dot(turned) - turned.dot(gram * turned);
  };
  double highest = 1.0;
  for (const TermSetting& setting : lines.settings) {
    highest = std::max(highest, setting.psi.front());
  }
  const double step = types::kTwoPi / (kStepsPerPeriod * highest);
  const double here = gain(0.0);
  double best = 0.0, most = here + least;
  for (int k = 1; k * step <= std::numbers::pi; ++k) {
    for (const double turn_rad : {k * step, -k * step}) {
      const double found = gain(turn_rad);
      if (found <= most) continue;
      most = found;
      best = turn_rad;
    }
  }
  return best;
}

}  // namespace

double Facts::Score() const {
  const double off = Assessed() ? std::min(2.0, std::abs(1.0 - *slope)) : kUnassessed;
  const double z = 2.0 - 2.4 * curve - 3.3 * off;
  return 1.0 / (1.0 + std::exp(-z));
}

void Facts::SetSlope(const Confirmation& confirmation) {
  blocks = confirmation.blocks;
  slope.reset();
  if (!(confirmation.upper > confirmation.lower)) return;
  slope = confirmation.slope;
  error = (confirmation.upper - confirmation.lower) / (2.0 * k95);
}

Confirmation Facts::AsConfirmation() const {
  Confirmation out;
  out.blocks = blocks;
  if (!slope) return out;
  out.slope = *slope;
  out.lower = *slope - k95 * error;
  out.upper = *slope + k95 * error;
  return out;
}

void Assess(const Facts& facts, const std::optional<Refusal>& refusal, const InForce& in_force,
            FoundEffect* found) {
  found->score = facts.Score();
  found->curve = facts.curve;
  found->confirmation = facts.AsConfirmation();
  if (refusal) {
    found->confirmation.verdict = ConfirmationVerdict::kRefuted;
    found->refusal = *refusal;
  } else if (found->score >= in_force.Limit(rules::kScore)) {
    found->confirmation.verdict = ConfirmationVerdict::kConfirmed;
  } else {
    found->refusal = in_force.RefusedBy(rules::kScore, found->score);
  }
}

double CurveBeside(const Problem& problem, const EffectSet& set) {
  const EffectSet with = WithBestCurve(problem.choices(), set);
  if (with.empty() || !(set.net > 0.0)) return 0.0;
  return std::max(0.0, (with.net - set.net) / set.net);
}

std::vector<ZeroTurn> FindZeroTurns(const Problem& problem, const EffectSet& set, std::size_t k,
                                    const identify::FitResult& declared_fit,
                                    const Likelihood& train, identify::Design* held_out) {
  std::vector<ZeroTurn> out;
  const Hypothesis& member = problem.hypotheses()[set.members[k]];
  if (member.effect->info().ripple != effects::Side::kMotor || member.settings.size() < 2) {
    return out;
  }
  const HeldOutBalance balance(problem, *held_out, declared_fit, train);
  if (!balance.usable()) return out;
  Eigen::Index at = 0;
  for (std::size_t j = 0; j < k; ++j) {
    at += static_cast<Eigen::Index>(problem.hypotheses()[set.members[j]].columns.size());
  }
  const Eigen::MatrixXd columns = balance.Columns(member);
  const Eigen::VectorXd c = set.c.segment(at, columns.cols());
  const Eigen::VectorXd rest = balance.Left(set) + columns * c;
  // The noise is what lines of any size and phase leave there.
  Likelihood likelihood = balance.likelihood();
  LearnNoise(*held_out, identify::LeftBy(columns, rest), declared_fit.model.balance, &likelihood);
  for (std::size_t run = 0; run < held_out->states().run_names.size(); ++run) {
    Eigen::VectorXd of_run = Eigen::VectorXd::Zero(rest.size());
    for (Eigen::Index i = 0; i < rest.size(); ++i) {
      const Eigen::Index row = balance.used().rows[static_cast<std::size_t>(i)];
      of_run[i] = held_out->rows().RunOf(row) == run ? 1.0 : 0.0;
    }
    const Eigen::MatrixXd own = of_run.asDiagonal() * columns;
    const Eigen::VectorXd own_rest = of_run.cwiseProduct(rest);
    const double turn_rad =
        BestTurn(member, c, Whiten(likelihood, own), Whiten(likelihood, own_rest).col(0),
                 problem.in_force().Limit(rules::kEvidence));
    if (turn_rad == 0.0) continue;
    held_out->SetMotorTurn(static_cast<int>(run), turn_rad);
    out.push_back({member.name, held_out->states().run_names[run], turn_rad});
  }
  return out;
}

Facts FactsOf(const Problem& problem, const EffectSet& set, std::size_t k,
              const identify::Design& held_out, const identify::FitResult& declared_fit,
              const Likelihood& train) {
  Facts out;
  const Hypothesis& member = problem.hypotheses()[set.members[k]];
  const EffectSet without = WithoutMember(problem.choices(), set, k);
  if (member.effect->info().event) return out;

  const HeldOutBalance balance(problem, held_out, declared_fit, train);
  out.blocks = static_cast<int>(balance.used().blocks.size());
  if (!balance.usable()) return out;
  // The change by the member, the declared terms refitted in training with and without it.
  const Eigen::VectorXd rest = balance.Left(set);
  const Eigen::VectorXd own = balance.Left(without) - rest;
  Likelihood likelihood = balance.likelihood();
  const Nuisances nuisances = MakeNuisances(held_out, likelihood, declared_fit.model);
  const Prior prior{
      nuisances.mean,
      (nuisances.spread.array() > 0.0).select(nuisances.spread.array().square().inverse(), 0.0)};
  // Twice: the noise is what the imperfections leave. rest = own (slope - 1) + imperfections.
  // Training on held positions leaves white noise: it has no weights for what is quick.
  const auto learn = [&](const Eigen::VectorXd& left_over) {
    if (train.noise.order() == 0) {
      SetNoise(left_over, left_over.size(), 0, &likelihood);
    } else {
      LearnNoise(held_out, left_over, declared_fit.model.balance, &likelihood);
    }
  };
  learn(rest);
  for (int pass = 0; pass < 2; ++pass) {
    const Evidence evidence(Whiten(likelihood, nuisances.columns), prior, Whiten(likelihood, own),
                            Eigen::VectorXd::Zero(1), Whiten(likelihood, rest).col(0));
    const Eigen::VectorXd more = evidence.Solve({0});
    if (pass == 0) {
      learn(rest - own * more - nuisances.columns * evidence.Declared({0}, more));
      continue;
    }
    out.error = std::sqrt(std::max(0.0, evidence.Covariance({0})(0, 0)));
    if (out.error > 0.0 && std::isfinite(out.error)) out.slope = 1.0 + more[0];
  }
  return out;
}

Confirmation ConfirmSlope(const Eigen::Ref<const Eigen::VectorXd>& left_over,
                          const Eigen::Ref<const Eigen::VectorXd>& change,
                          const std::vector<identify::Block>& blocks, const InForce& in_force) {
  Confirmation out;
  out.blocks = static_cast<int>(blocks.size());
  const double power = change.squaredNorm();
  // One block has no scatter, whatever the rule allows.
  const double fewest = std::max(2.0, in_force.Limit(rules::kHeldOutBlocks));
  if (!(power > 0.0) || static_cast<double>(blocks.size()) < fewest) return out;
  out.slope = change.dot(left_over) / power;
  double meat = 0.0;
  for (const identify::Block& block : blocks) {
    const auto rows = static_cast<Eigen::Index>(block.size());
    const auto d = change.segment(block.front(), rows);
    const double score =
        d.dot(left_over.segment(block.front(), rows)) - out.slope * d.squaredNorm();
    meat += score * score;
  }
  const auto count = static_cast<double>(blocks.size());
  const double error = std::sqrt(meat * count / (count - 1.0)) / power;
  const double half = identify::StudentQuantile(0.975, count - 1.0) * error;
  out.lower = out.slope - half;
  out.upper = out.slope + half;
  return out;
}

Confirmation ConfirmSlope(const identify::Design& held_out, const identify::FitResult& without,
                          const identify::FitResult& with, const InForce& in_force) {
  Likelihood likelihood;
  likelihood.used = MakeUsedRows(held_out, kFewestRowsPerBlock);
  const auto left = [&](const identify::FitResult& fit) {
    identify::FitResult there = fit;
    there.balance = identify::MakeBalance(held_out, fit.model, fit.balance.fits_scale);
    return LeftOver(there, likelihood.used);
  };
  const Eigen::VectorXd before = left(without), after = left(with);
  LearnNoise(held_out, after, with.model.balance, &likelihood);
  return ConfirmSlope(Whiten(likelihood, before), Whiten(likelihood, before - after),
                      likelihood.used.blocks, in_force);
}

}  // namespace sinew::trace
