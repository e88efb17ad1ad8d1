// Factor of the inertia matrix of a tree, without the fill-in that Cholesky's has:
//
//     M = L' L,   L lower triangular, L(i, j) not 0 only where j is i or on i's way to the base
//
// (Featherstone: Rigid Body Dynamics Algorithms, 6.3 to 6.5). Conditioning: as of Cholesky's, no
// pivoting is needed for positive definite M. Thread: one. Only the constructor allocates.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sinew::world {

class TreeFactor {
 public:
  // parents[i] < i: the row next to i on the way to the base, -1 for none. Throws
  // std::invalid_argument otherwise.
  explicit TreeFactor(std::vector<int> parents);

  int size() const { return static_cast<int>(parents_.size()); }

  // Reads M(i, j) for j that is i or on i's way to the base. False: M is not positive definite, or
  // not finite; the factor is of no use then.
  [[nodiscard]] bool Factor(const Eigen::Ref<const Eigen::MatrixXd>& matrix) noexcept;

  // x = M^-1 x.
  void Solve(Eigen::Ref<Eigen::VectorXd> x) const noexcept;

  // Rows and columns from `first` on of M^-1, symmetric.
  void InverseFrom(int first, Eigen::Ref<Eigen::MatrixXd> inverse) noexcept;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // x = L'^-1 x, for an x that is 0 but at `from` and on its way to the base.
  template <typename Vector>
  void SolveTransposed(int from, Vector&& x) const noexcept;

  std::vector<int> parents_;
  RowMajor factor_;
  Eigen::MatrixXd columns_;  // work space of InverseFrom
};

}  // namespace sinew::world
