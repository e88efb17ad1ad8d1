#include "components/model/trace/null_test.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace sinew::trace {

double GainStatistic(double gain, const Hypothesis& hypothesis) {
  const double k = static_cast<double>(hypothesis.columns.size());
  const double spread = 2.0 / (9.0 * k);
  return (std::cbrt(std::max(0.0, gain - hypothesis.charge) / k) - (1.0 - spread)) /
         std::sqrt(spread);
}

double GainOfStatistic(double statistic, const Hypothesis& hypothesis) {
  const double k = static_cast<double>(hypothesis.columns.size());
  const double spread = 2.0 / (9.0 * k);
  const double root = std::max(0.0, statistic * std::sqrt(spread) + 1.0 - spread);
  return hypothesis.charge + k * root * root * root;
}

NullTest::NullTest(const Eigen::Ref<const Eigen::MatrixXd>& X,
                   const Eigen::Ref<const Eigen::MatrixXd>& Z,
                   const Eigen::Ref<const Eigen::VectorXd>& noise, const Evidence& evidence,
                   const std::vector<Hypothesis>& hypotheses, const Columns& given,
                   const std::vector<identify::Block>& blocks, int rounds, std::uint64_t seed) {
  const auto count = static_cast<Eigen::Index>(blocks.size());
  Eigen::MatrixXd scores(Z.cols(), count);
  for (Eigen::Index b = 0; b < count; ++b) {
    const identify::Block& block = blocks[static_cast<std::size_t>(b)];
    const Eigen::Index first = block.front();
    const auto rows = static_cast<Eigen::Index>(block.size());  // blocks are contiguous
    const auto e = noise.segment(first, rows);
    scores.col(b) = Z.middleRows(first, rows).transpose() * e -
                    evidence.Projection().transpose() * (X.middleRows(first, rows).transpose() * e);
  }
  Eigen::MatrixXd signs(count, rounds);
  std::mt19937_64 random(seed);
  for (Eigen::Index r = 0; r < rounds; ++r) {
    for (Eigen::Index b = 0; b < count; ++b) signs(b, r) = (random() & 1) != 0 ? 1.0 : -1.0;
  }
  Eigen::MatrixXd m = scores * signs;  // Z x rounds
  const Eigen::MatrixXd& G = evidence.reduced();
  Eigen::MatrixXd freed;  // (G_SS + Q)^-1 G_S.
  if (!given.empty()) {
    Eigen::MatrixXd A = G(given, given);
    for (std::size_t k = 0; k < given.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      A(i, i) += evidence.precision()[given[k]] + kRidge * A(i, i) + 1e-300;
    }
    freed = A.ldlt().solve(G(given, Eigen::all));
    const Eigen::MatrixXd m_given = m(given, Eigen::all);
    m -= freed.transpose() * m_given;
  }
  Eigen::VectorXd largest = Eigen::VectorXd::Constant(rounds, -1e300);
  for (const Hypothesis& h : hypotheses) {
    if (h.asked != Asked::kSearched) continue;
    Eigen::MatrixXd A = G(h.columns, h.columns);
    if (!given.empty()) {
      const Eigen::MatrixXd cross = G(given, h.columns);
      const Eigen::MatrixXd part = freed(Eigen::all, h.columns);
      A -= cross.transpose() * part;
    }
    for (std::size_t k = 0; k < h.columns.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const Eigen::Index j = h.columns[k];
      A(i, i) += evidence.precision()[j] + kRidge * G(j, j) + 1e-300;
    }
    const Eigen::MatrixXd mine = m(h.columns, Eigen::all);
    const Eigen::MatrixXd solved = A.ldlt().solve(mine);
    Hypothesis plain = h;
    plain.charge = 0.0;  // the search's columns are fixed here
    for (Eigen::Index r = 0; r < rounds; ++r) {
      largest[r] = std::max(largest[r], GainStatistic(mine.col(r).dot(solved.col(r)), plain));
    }
  }
  largest_.assign(largest.data(), largest.data() + largest.size());
  std::sort(largest_.begin(), largest_.end());
}

double NullTest::P(double statistic) const {
  const auto reach = largest_.end() - std::lower_bound(largest_.begin(), largest_.end(), statistic);
  return (1.0 + static_cast<double>(reach)) / (1.0 + static_cast<double>(largest_.size()));
}

double NullTest::Least(double p) const {
  const double rounds = static_cast<double>(largest_.size());
  const double reach = std::floor(p * (1.0 + rounds) + 1e-9) - 1.0;  // that may reach it
  if (reach < 0.0) return std::numeric_limits<double>::infinity();
  if (reach >= rounds) return -std::numeric_limits<double>::infinity();
  return largest_[largest_.size() - 1 - static_cast<std::size_t>(reach)];
}

}  // namespace sinew::trace
