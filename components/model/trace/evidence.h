// Gaussian likelihood of a balance with declared terms, and what further columns add to it.
//
//     y = X b + Z c + e,   e ~ N(0, 1) (whitened, noise_model.h)
//     b_i ~ N(b0_i, 1 / P_i),   c_j ~ N(0, 1 / Q_j)   (precision 0: flat)
//
// The misfit is minus twice the log of likelihood times priors, up to a constant:
//
//     misfit(b, c) = |y - X b - Z c|^2 + sum_i P_i (b_i - b0_i)^2 + sum_j Q_j c_j^2
//
// b is eliminated once (Schur complement); then the gain of any subset of columns of Z, the misfit
// that it takes away, costs one small system. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sinew::trace {

using Columns = std::vector<Eigen::Index>;

// Precision that every column has at least, of its power: two columns that agree to this part are
// one column and share their coefficient.
inline constexpr double kRidge = 1e-9;

struct Prior {
  Eigen::VectorXd mean;
  Eigen::VectorXd precision;  // 0: flat
};

class Evidence {
 public:
  Evidence(const Eigen::Ref<const Eigen::MatrixXd>& X, const Prior& prior_of_X,
           const Eigen::Ref<const Eigen::MatrixXd>& Z, const Eigen::VectorXd& precision_of_Z,
           const Eigen::Ref<const Eigen::VectorXd>& y);

  // Misfit of the declared terms alone, at their best.
  double misfit() const { return misfit_; }
  // Part of the misfit that is the priors' of the declared terms, with those columns of Z.
  double PriorMisfit(const Columns& columns, const Eigen::VectorXd& c) const;
  // Cost of the prior widths of columns to their marginal likelihood, twice its logarithm:
  // ln det(G + Q) - ln det Q.
  double Occam(const Columns& columns) const;
  // Misfit that the columns of Z take away; >= 0.
  double Gain(const Columns& columns) const;
  // Their coefficients where the misfit is least, and the covariance of white noise.
  Eigen::VectorXd Solve(const Columns& columns) const;
  Eigen::MatrixXd Covariance(const Columns& columns) const;
  // Coefficients of the declared columns with those of Z given.
  Eigen::VectorXd Declared(const Columns& columns, const Eigen::VectorXd& c) const;

  // Gram matrix of Z freed of the declared columns, priors of Z not counted.
  const Eigen::MatrixXd& reduced() const { return G_; }
  // Z freed of the declared columns: Z - X Projection().
  const Eigen::MatrixXd& Projection() const { return B_; }
  const Eigen::VectorXd& precision() const { return precision_; }
  // Part of the power of column j that the declared columns do not carry.
  double FreeShare(Eigen::Index j) const;

 private:
  // Precision of a column's coefficient: its prior's, and the ridge.
  double Precision(Eigen::Index column) const {
    return precision_[column] + kRidge * power_[column] + 1e-300;
  }
  // Reduced Gram matrix of some columns with their precisions.
  Eigen::MatrixXd Normal(const Columns& columns) const;

  Eigen::MatrixXd G_;  // reduced Gram matrix of Z
  Eigen::VectorXd m_;  // reduced Z' y
  Eigen::MatrixXd B_;  // (X'X + P)^-1 X'Z
  Eigen::VectorXd b_;  // declared alone
  Prior prior_;        // of the declared columns
  Eigen::VectorXd precision_, power_;
  double misfit_ = 0.0;
};

}  // namespace sinew::trace
