// Least squares from sums over blocks of rows, so that leaving blocks out, flipping their sign and
// honest standard errors cost only small matrices.
// Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/model/identify/design.h"

namespace sinew::identify {

using Block = std::vector<Eigen::Index>;  // row numbers

// Windows of `length_s` along every segment, as even as they come; rows nearer than gap_s to a
// window's inner border are left out, windows with fewer than `fewest_rows` used rows are joined to
// the next.
std::vector<Block> MakeBlocks(const Rows& rows, double length_s, double gap_s, int fewest_rows);

// Sums of one block: G = X'X, m = X'y, yy = y'y.
struct Moments {
  Eigen::MatrixXd G;
  Eigen::VectorXd m;
  double yy = 0.0;
  double rows = 0.0;

  double SquaredError(const Eigen::Ref<const Eigen::VectorXd>& b) const;
};

Moments MomentsOf(const Block& block, const Eigen::Ref<const Eigen::MatrixXd>& X,
                  const Eigen::Ref<const Eigen::VectorXd>& y);

// Minimises |y - X b|^2 with a ridge of 1e-9 of each column's own power, so that columns that
// cannot be distinguished share their part; the others are unchanged.
Eigen::VectorXd Solve(const Eigen::Ref<const Eigen::MatrixXd>& G,
                      const Eigen::Ref<const Eigen::VectorXd>& m);
// Residual of y by least squares with the columns of X.
Eigen::VectorXd LeftBy(const Eigen::Ref<const Eigen::MatrixXd>& X,
                       const Eigen::Ref<const Eigen::VectorXd>& y);
Eigen::MatrixXd Inverse(const Eigen::Ref<const Eigen::MatrixXd>& G);

// Covariance of least-squares coefficients from the scores of blocks (cluster-robust sandwich;
// Cameron, Miller: J. Human Resources 50 (2015) 317): holds for residuals correlated inside blocks.
// With the small- sample factor B / (B - 1) (n - 1) / (n - p).
Eigen::MatrixXd BlockCovariance(const std::vector<Moments>& blocks,
                                const Eigen::Ref<const Eigen::VectorXd>& b);

}  // namespace sinew::identify
