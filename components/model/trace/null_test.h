// p-values of a search over the whole bank: how often it finds as much without any effect.
//
// Wild bootstrap with Rademacher weights of whole blocks (Cameron, Gelbach, Miller 2008): the
// scores that the noise of a block has with every column get a random sign, and the same search is
// scored again. The noise is the residual of the best model found (ter Braak 1992: a strong effect
// would be its own noise). Hypotheses of different size are compared by the normal quantile of
// their gain (Wilson, Hilferty 1931: the distribution of chi-square). Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "components/model/identify/block_regression.h"
#include "components/model/trace/evidence.h"
#include "components/model/trace/hypotheses.h"

namespace sinew::trace {

// Normal quantile of a gain by `parameters` columns, less what its search was charged.
double GainStatistic(double gain, const Hypothesis& hypothesis);

// Least gain with that statistic.
double GainOfStatistic(double statistic, const Hypothesis& hypothesis);

class NullTest {
 public:
  // X, Z: whitened declared columns and bank; noise: whitened residual of the best model; given:
  // the columns of Z that are in the model already.
  NullTest(const Eigen::Ref<const Eigen::MatrixXd>& X, const Eigen::Ref<const Eigen::MatrixXd>& Z,
           const Eigen::Ref<const Eigen::VectorXd>& noise, const Evidence& evidence,
           const std::vector<Hypothesis>& hypotheses, const Columns& given,
           const std::vector<identify::Block>& blocks, int rounds, std::uint64_t seed);

  // Share of searches without an effect whose largest statistic reaches this one; at least
  // 1 / (rounds + 1).
  double P(double statistic) const;
  // Value that a statistic must exceed so that its P is at most p; infinite: no statistic does.
  double Least(double p) const;
  // Largest statistic of every round.
  const std::vector<double>& largest() const { return largest_; }

 private:
  std::vector<double> largest_;  // sorted
};

}  // namespace sinew::trace
