#include "sim/world/tree_factor.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::world {

TreeFactor::TreeFactor(std::vector<int> parents) : parents_(std::move(parents)) {
  for (int i = 0; i < size(); ++i) {
    const int parent = parents_[static_cast<std::size_t>(i)];
    if (parent < -1 || parent >= i) {
      throw std::invalid_argument("parent " + std::to_string(parent) + " of row " +
                                  std::to_string(i) + ", expected -1 or a row before it");
    }
  }
  factor_ = RowMajor::Zero(size(), size());
  columns_ = Eigen::MatrixXd::Zero(size(), size());
}

bool TreeFactor::Factor(const Eigen::Ref<const Eigen::MatrixXd>& matrix) noexcept {
  const int* parent = parents_.data();
  for (int i = 0; i < size(); ++i) {
    for (int j = i; j >= 0; j = parent[j]) factor_(i, j) = matrix(i, j);
  }
  for (int k = size() - 1; k >= 0; --k) {
    if (!(factor_(k, k) > 0.0) || !std::isfinite(factor_(k, k))) return false;
    factor_(k, k) = std::sqrt(factor_(k, k));
    for (int i = parent[k]; i >= 0; i = parent[i]) factor_(k, i) /= factor_(k, k);
    for (int i = parent[k]; i >= 0; i = parent[i]) {
      for (int j = i; j >= 0; j = parent[j]) factor_(i, j) -= factor_(k, i) * factor_(k, j);
    }
  }
  return true;
}

template <typename Vector>
void TreeFactor::SolveTransposed(int from, Vector&& x) const noexcept {
  for (int i = from; i >= 0; i = parents_[static_cast<std::size_t>(i)]) {
    x[i] /= factor_(i, i);
    for (int j = parents_[static_cast<std::size_t>(i)]; j >= 0;
         j = parents_[static_cast<std::size_t>(j)]) {
      x[j] -= factor_(i, j) * x[i];
    }
  }
}

void TreeFactor::Solve(Eigen::Ref<Eigen::VectorXd> x) const noexcept {
  const int* parent = parents_.data();
  for (int i = size() - 1; i >= 0; --i) {
    x[i] /= factor_(i, i);
    for (int j = parent[i]; j >= 0; j = parent[j]) x[j] -= factor_(i, j) * x[i];
  }
  for (int i = 0; i < size(); ++i) {
    for (int j = parent[i]; j >= 0; j = parent[j]) x[i] -= factor_(i, j) * x[j];
    x[i] /= factor_(i, i);
  }
}

// M^-1 = L^-1 L'^-1: entry (i, j) is the product of the columns L'^-1 e_i and L'^-1 e_j, which are
// 0 below i and j.
void TreeFactor::InverseFrom(int first, Eigen::Ref<Eigen::MatrixXd> inverse) noexcept {
  for (int i = first; i < size(); ++i) {
    columns_.col(i).setZero();
    columns_(i, i) = 1.0;
    SolveTransposed(i, columns_.col(i));
    for (int j = first; j <= i; ++j) {
      inverse(i - first, j - first) = inverse(j - first, i - first) =
          columns_.col(i).head(j + 1).dot(columns_.col(j).head(j + 1));
    }
  }
}

}  // namespace sinew::world
