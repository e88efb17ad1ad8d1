#include "bench/rigs/drawn/likelihood.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace sinew::rigs {
namespace {

// Least squares by the normal equations of unit columns, a ridge of rounding size for columns that
// are equivalent.
Eigen::MatrixXd FreeOf(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& values,
                       const Eigen::VectorXd& prior_weight) {
  if (columns.cols() == 0) return values;
  Eigen::VectorXd scale = columns.colwise().norm().transpose();
  for (Eigen::Index c = 0; c < scale.size(); ++c) scale[c] = scale[c] > 0.0 ? scale[c] : 1.0;
  const Eigen::MatrixXd unit = columns * scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd gram = unit.transpose() * unit;
  for (Eigen::Index c = 0; c < scale.size(); ++c) {
    const double w = prior_weight[c] / scale[c];
    gram(c, c) += 1e-10 + w * w;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(gram);
  const Eigen::MatrixXd right = unit.transpose() * values;
  return values - unit * solver.solve(right);
}

Eigen::VectorXd NoPrior(const Balance& balance) {
  return Eigen::VectorXd::Zero(balance.columns.cols());
}

}  // namespace

Eigen::VectorXd RefitResidual(const Balance& balance) {
  return FreeOf(balance.columns, balance.response, NoPrior(balance));
}

Common CommonRows(const std::vector<int>& left, const std::vector<int>& right) {
  Common out;
  std::size_t i = 0, k = 0;
  while (i < left.size() && k < right.size()) {
    if (left[i] == right[k]) {
      out.left.push_back(static_cast<Eigen::Index>(i++));
      out.right.push_back(static_cast<Eigen::Index>(k++));
    } else if (left[i] < right[k]) {
      ++i;
    } else {
      ++k;
    }
  }
  return out;
}

Eigen::VectorXd FitAr(const Eigen::VectorXd& residual, const std::vector<int>& row, int order) {
  Eigen::VectorXd r = Eigen::VectorXd::Zero(order + 1);
  const auto n = residual.size();
  for (int lag = 0; lag <= order; ++lag) {
    for (Eigen::Index k = lag; k < n; ++k) {
      const auto a = static_cast<std::size_t>(k), b = static_cast<std::size_t>(k - lag);
      if (row[a] - row[b] == lag) r[lag] += residual[k] * residual[k - lag];
    }
  }
  if (!(r[0] > 0.0)) return Eigen::VectorXd::Zero(order);
  Eigen::MatrixXd toeplitz(order, order);
  for (int i = 0; i < order; ++i) {
    for (int k = 0; k < order; ++k) toeplitz(i, k) = r[std::abs(i - k)];
    toeplitz(i, i) += 1e-6 * r[0];
  }
  return toeplitz.ldlt().solve(r.tail(order));
}

Eigen::MatrixXd Whiten(const Eigen::MatrixXd& values, const std::vector<int>& row,
                       const Eigen::VectorXd& ar) {
  const auto order = ar.size();
  Eigen::MatrixXd out(values.rows(), values.cols());
  Eigen::Index kept = 0;
  for (Eigen::Index k = order; k < values.rows(); ++k) {
    const auto a = static_cast<std::size_t>(k), b = static_cast<std::size_t>(k - order);
    if (row[a] - row[b] != order) continue;
    out.row(kept) = values.row(k);
    for (Eigen::Index i = 0; i < order; ++i) out.row(kept) -= ar[i] * values.row(k - 1 - i);
    ++kept;
  }
  out.conservativeResize(kept, Eigen::NoChange);
  return out;
}

double Lambda(const Balance& balance, const Eigen::VectorXd& signature, bool with_priors) {
  const auto n = balance.response.size();
  const auto width = balance.columns.cols();
  if (n < 4 * (width + kArOrder) || !(signature.squaredNorm() > 0.0)) return 0.0;
  // Noise from the residual of the richest model: declared columns and the effect.
  Eigen::MatrixXd rich(n, width + 1);
  rich << balance.columns, signature;
  const Eigen::VectorXd left =
      FreeOf(rich, balance.response, Eigen::VectorXd::Zero(width + 1)).col(0);
  const Eigen::VectorXd ar = FitAr(left, balance.row, kArOrder);
  const Eigen::MatrixXd white = Whiten(rich, balance.row, ar);
  const Eigen::VectorXd noise = Whiten(left, balance.row, ar).col(0);
  if (white.rows() < 2 * width) return 0.0;
  const double variance = noise.squaredNorm() / static_cast<double>(noise.size());
  if (!(variance > 0.0)) return 0.0;
  Eigen::VectorXd weight = NoPrior(balance);
  for (Eigen::Index c = 0; with_priors && c < width; ++c) {
    weight[c] = std::sqrt(variance) / balance.prior_sd[c];
  }
  const Eigen::MatrixXd columns = white.leftCols(width);
  const Eigen::VectorXd d = white.col(width);
  // With priors the generalised least squares estimate of s has information d' (d - X (X'X + W)^-1
  // X' d).
  return std::max(0.0, d.dot(FreeOf(columns, d, weight).col(0))) / variance;
}

double LossOfFit(const Balance& balance, const Eigen::VectorXd& signature,
                 const Eigen::MatrixXd& others, const Eigen::VectorXd& ar) {
  Eigen::MatrixXd all(signature.size(), balance.columns.cols() + 1 + others.cols());
  all << balance.columns, signature, others;
  const Eigen::MatrixXd white = Whiten(all, balance.row, ar);
  const auto width = balance.columns.cols();
  const Eigen::MatrixXd free =
      FreeOf(white.leftCols(width), white.rightCols(1 + others.cols()), NoPrior(balance));
  const Eigen::VectorXd d = free.col(0);
  const double energy = d.squaredNorm();
  if (!(energy > 0.0)) return 1.0;
  const Eigen::MatrixXd fit = free.rightCols(others.cols());
  const Eigen::VectorXd rest = FreeOf(fit, d, Eigen::VectorXd::Zero(fit.cols())).col(0);
  return rest.squaredNorm() / energy;
}

}  // namespace sinew::rigs
