#include "components/model/trace/confirmation.h"

#include <algorithm>
#include <cmath>

#include "components/model/identify/statistics.h"
#include "components/model/trace/problem.h"

namespace sinew::trace {

std::string_view ConfirmationWord(ConfirmationVerdict verdict) {
  switch (verdict) {
    case ConfirmationVerdict::kConfirmed:
      return "confirmed";
    case ConfirmationVerdict::kRefuted:
      return "refuted";
    case ConfirmationVerdict::kNotConfirmed:
      break;
  }
  return "not confirmed";
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
