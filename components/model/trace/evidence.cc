#include "components/model/trace/evidence.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sinew::trace {

Evidence::Evidence(const Eigen::Ref<const Eigen::MatrixXd>& X, const Prior& prior_of_X,
                   const Eigen::Ref<const Eigen::MatrixXd>& Z,
                   const Eigen::VectorXd& precision_of_Z,
                   const Eigen::Ref<const Eigen::VectorXd>& y)
    : prior_(prior_of_X), precision_(precision_of_Z) {
  Eigen::MatrixXd A = X.transpose() * X;
  A.diagonal() += prior_of_X.precision;
  for (Eigen::Index i = 0; i < A.rows(); ++i) A(i, i) += kRidge * A(i, i) + 1e-300;
  const Eigen::LDLT<Eigen::MatrixXd> factor(A);
  // Deviations from the prior's mean: the ridge pulls toward what was declared.
  const Eigen::VectorXd target = y - X * prior_of_X.mean;
  const Eigen::VectorXd deviation = factor.solve(X.transpose() * target);
  b_ = prior_of_X.mean + deviation;
  B_ = Eigen::MatrixXd::Zero(X.cols(), Z.cols());
  if (Z.cols() > 0) {  // Eigen's products and solvers refuse matrices without columns
    const Eigen::MatrixXd cross = X.transpose() * Z;
    B_ = factor.solve(cross);
    G_ = Eigen::MatrixXd::Zero(Z.cols(), Z.cols());
    G_.selfadjointView<Eigen::Lower>().rankUpdate(Z.transpose());
    G_.triangularView<Eigen::StrictlyUpper>() = G_.transpose();
    power_ = G_.diagonal();
    G_.noalias() -= cross.transpose() * B_;
    m_ = Z.transpose() * target - cross.transpose() * deviation;
  }
  const Eigen::VectorXd e = target - X * deviation;
  misfit_ = e.squaredNorm() + (prior_of_X.precision.array() * deviation.array().square()).sum();
}

Eigen::MatrixXd Evidence::Normal(const Columns& columns) const {
  Eigen::MatrixXd out = G_(columns, columns);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    out(i, i) += Precision(columns[k]);
  }
  return out;
}

Eigen::VectorXd Evidence::Solve(const Columns& columns) const {
  const Eigen::VectorXd m = m_(columns);
  return Normal(columns).ldlt().solve(m);
}

double Evidence::Occam(const Columns& columns) const {
  if (columns.empty()) return 0.0;
  double out = 0.0;
  for (const Eigen::Index column : columns) out -= std::log(Precision(column));
  const Eigen::VectorXd d = Normal(columns).ldlt().vectorD();
  for (const double value : d) out += std::log(std::max(value, 1e-300));
  return std::max(0.0, out);
}

double Evidence::Gain(const Columns& columns) const {
  if (columns.empty()) return 0.0;
  const Eigen::VectorXd c = Solve(columns);
  double gain = 0.0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    gain += c[static_cast<Eigen::Index>(k)] * m_[columns[k]];
  }
  return std::max(0.0, gain);
}

Eigen::MatrixXd Evidence::Covariance(const Columns& columns) const {
  const auto count = static_cast<Eigen::Index>(columns.size());
  return Normal(columns).ldlt().solve(Eigen::MatrixXd::Identity(count, count));
}

Eigen::VectorXd Evidence::Declared(const Columns& columns, const Eigen::VectorXd& c) const {
  Eigen::VectorXd out = b_;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    out -= B_.col(columns[k]) * c[static_cast<Eigen::Index>(k)];
  }
  return out;
}

double Evidence::PriorMisfit(const Columns& columns, const Eigen::VectorXd& c) const {
  const Eigen::VectorXd deviation = Declared(columns, c) - prior_.mean;
  return (prior_.precision.array() * deviation.array().square()).sum();
}

double Evidence::FreeShare(Eigen::Index j) const {
  return power_[j] > 0.0 ? std::max(0.0, G_(j, j) / power_[j]) : 0.0;
}

}  // namespace sinew::trace
