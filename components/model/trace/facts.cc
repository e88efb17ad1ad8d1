#include "components/model/trace/facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace sinew::trace {

namespace {

// Share of the misfit that a low-pass or a drive loop imitates at most. Provisional.
constexpr double kMostOfFilter = 0.1;
// A slope that cannot be assessed costs as much as one of 0.25: without the held-out recordings
// nothing is named.
constexpr double kUnassessed = 0.75;
constexpr std::array kDynamic = {"flexible_link", "elastic_joint", "gear_compliance",
                                 "transport_delay"};

// The contribution of a hypothesis with its coefficients at the used rows of other recordings.
Eigen::VectorXd Contribution(const identify::Design& design, const UsedRows& used,
                             const Hypothesis& h, const Eigen::Ref<const Eigen::VectorXd>& c) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(used.size());
  Eigen::Index at = 0;
  for (const TermSetting& setting : h.settings) {
    const Eigen::MatrixXd phi = -used.Of(design.Columns(*h.effect, setting.psi));
    out += phi * c.segment(at, phi.cols());
    at += phi.cols();
  }
  return out;
}

}  // namespace

double Facts::Score() const {
  const double off = Assessed() ? std::min(2.0, std::abs(1.0 - *slope)) : kUnassessed;
  const double z = 2.0 - 2.4 * curve - 3.3 * off - (dynamic ? 2.6 : 0.0);
  return 1.0 / (1.0 + std::exp(-z));
}

void Facts::SetSlope(const Confirmation& confirmation) {
  slope.reset();
  if (!(confirmation.upper > confirmation.lower)) return;
  slope = confirmation.slope;
  error = (confirmation.upper - confirmation.lower) / (2.0 * 1.96);
}

double CurveBeside(const Problem& problem, const EffectSet& set) {
  const EffectSet with = WithBestCurve(problem.evidence, problem.hypotheses(), set);
  if (with.empty() || !(set.net > 0.0)) return 0.0;
  return std::max(0.0, (with.net - set.net) / set.net);
}

Facts FactsOf(const Problem& problem, const EffectSet& set, std::size_t k,
              const identify::Design& held_out, const actuator::JointModel& declared_fit,
              bool keep_scale, const Likelihood& train) {
  Facts out;
  const Hypothesis& member = problem.hypotheses()[set.members[k]];
  const EffectSet without = WithoutMember(problem.evidence, problem.hypotheses(), set, k);
  const double share = (set.net - without.net) / problem.evidence.misfit();
  out.dynamic =
      share < kMostOfFilter && declared_fit.balance == effects::Balance::kMotion &&
      std::find(kDynamic.begin(), kDynamic.end(), std::string_view(member.name)) != kDynamic.end();
  if (member.effect->info().event) return out;

  Likelihood likelihood;
  likelihood.no_nuisance = train.no_nuisance;
  likelihood.used = MakeUsedRows(held_out, kFewestRowsPerBlock);
  const UsedRows& used = likelihood.used;
  const identify::Balance balance = identify::MakeBalance(held_out, declared_fit, keep_scale);
  if (balance.columns.cols() != problem.bank.parameters || used.size() < kFewestRowsPerBlock) {
    return out;
  }
  const Eigen::MatrixXd declared = used.Of(balance.columns);
  const Eigen::VectorXd target = balance.target(used.rows);
  const auto left = [&](const EffectSet& model) -> Eigen::VectorXd {
    const Eigen::VectorXd b =
        problem.evidence.Declared(model.columns, model.c).head(problem.bank.parameters);
    Eigen::VectorXd rest = target - declared * b;
    Eigen::Index at = 0;
    for (const std::size_t j : model.members) {
      const Hypothesis& h = problem.hypotheses()[j];
      const auto columns = static_cast<Eigen::Index>(h.columns.size());
      if (!h.effect->info().event) {
        rest -= Contribution(held_out, used, h, model.c.segment(at, columns));
      }
      at += columns;
    }
    return rest;
  };
  // What the member changes, the declared terms refitted in training with and without it.
  const Eigen::VectorXd rest = left(set);
  const Eigen::VectorXd own = left(without) - rest;
  const Nuisances nuisances = MakeNuisances(held_out, likelihood, declared_fit);
  const Prior prior{
      nuisances.mean,
      (nuisances.spread.array() > 0.0).select(nuisances.spread.array().square().inverse(), 0.0)};
  // Twice: the noise is what the imperfections leave. rest = own (slope - 1) + imperfections.
  // Training on held positions leaves white noise: it has no weights for what is quick.
  const auto learn = [&](const Eigen::VectorXd& left_over) {
    if (train.noise.order() == 0) {
      SetNoise(left_over, left_over.size(), 0, &likelihood);
    } else {
      LearnNoise(held_out, left_over, declared_fit.balance, &likelihood);
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

}  // namespace sinew::trace
