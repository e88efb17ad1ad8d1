#include "components/learn/esn/ridge.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "components/learn/esn/dispatch.h"

namespace sinew::esn {

using internal::kPanelColumns;
using internal::kPanelSamples;

NormalEquations::NormalEquations(int features, int outputs,
                                 std::optional<simd::Instructions> instructions)
    : features_(features),
      outputs_(outputs),
      columns_(internal::Padded(features + outputs, kPanelColumns)),
      instructions_(instructions ? *instructions : internal::FastestGram()) {
  if (features < 1 || outputs < 1) {
    throw std::invalid_argument("normal equations: " + std::to_string(features) + " features and " +
                                std::to_string(outputs) + " outputs, expected at least 1 of each");
  }
  simd::RequireRuns(instructions_);
  const std::size_t columns = static_cast<std::size_t>(columns_);
  panels_.assign(columns * kPanelSamples, 0.0);
  gram_.assign(columns * columns, 0.0);
}

bool NormalEquations::Add(const Eigen::Ref<const Eigen::VectorXd>& features,
                          const Eigen::Ref<const Eigen::VectorXd>& target) {
  if (features.size() != features_ || target.size() != outputs_ || !features.allFinite() ||
      !target.allFinite()) {
    return false;
  }
  double* sample = panels_.data() + buffered_ * kPanelColumns;
  for (int c = 0; c < features_ + outputs_; ++c) {
    const int panel = c / kPanelColumns;
    sample[panel * kPanelSamples * kPanelColumns + c % kPanelColumns] =
        c < features_ ? features(c) : target(c - features_);
  }
  ++samples_;
  if (++buffered_ == kPanelSamples) Flush();
  return true;
}

void NormalEquations::Flush() {
  if (buffered_ == 0) return;
  internal::KernelFor(instructions_).gram(panels_.data(), columns_, gram_.data());
  std::fill(panels_.begin(), panels_.end(), 0.0);
  buffered_ = 0;
}

double NormalEquations::Entry(int row, int column) const {
  if (row > column) std::swap(row, column);
  return gram_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column)];
}

Eigen::MatrixXd NormalEquations::FeatureProducts() {
  Flush();
  Eigen::MatrixXd products(features_, features_);
  for (int c = 0; c < features_; ++c) {
    for (int r = 0; r < features_; ++r) products(r, c) = Entry(r, c);
  }
  return products;
}

Eigen::MatrixXd NormalEquations::CrossProducts() {
  Flush();
  Eigen::MatrixXd products(features_, outputs_);
  for (int o = 0; o < outputs_; ++o) {
    for (int r = 0; r < features_; ++r) products(r, o) = Entry(r, features_ + o);
  }
  return products;
}

Eigen::VectorXd NormalEquations::TargetSquares() {
  Flush();
  Eigen::VectorXd squares(outputs_);
  for (int o = 0; o < outputs_; ++o) squares(o) = Entry(features_ + o, features_ + o);
  return squares;
}

Eigen::MatrixXd SolveRidge(NormalEquations& equations, double beta) {
  if (!std::isfinite(beta) || beta < 0.0) {
    throw std::invalid_argument("ridge_beta: " + std::to_string(beta) +
                                ", expected a finite number, at least 0");
  }
  Eigen::MatrixXd left = equations.FeatureProducts();
  left.diagonal().array() += beta;
  const Eigen::LLT<Eigen::MatrixXd> factors(left);
  if (factors.info() != Eigen::Success) {
    throw std::invalid_argument(
        "ridge: " + std::to_string(equations.samples()) + " samples for " +
        std::to_string(equations.feature_count()) +
        " features leave the weights undetermined; take a larger ridge_beta");
  }
  return factors.solve(equations.CrossProducts()).transpose();
}

std::vector<GcvPoint> GeneralisedCrossValidation(NormalEquations& equations,
                                                 const std::vector<double>& betas) {
  if (betas.empty()) throw std::invalid_argument("gcv: no values of beta");
  for (const double beta : betas) {
    if (!std::isfinite(beta) || beta <= 0.0) {
      throw std::invalid_argument("gcv: beta " + std::to_string(beta) +
                                  ", expected a number above 0");
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(equations.FeatureProducts());
  // Rounding makes the smallest ones negative.
  const Eigen::ArrayXd lambda = eigen.eigenvalues().array().max(0.0);
  const Eigen::MatrixXd projected = eigen.eigenvectors().transpose() * equations.CrossProducts();
  const Eigen::VectorXd squares = equations.TargetSquares();
  const double samples = static_cast<double>(equations.samples());

  std::vector<GcvPoint> points;
  points.reserve(betas.size());
  for (const double beta : betas) {
    GcvPoint point;
    point.beta = beta;
    point.effective_parameters = (lambda / (lambda + beta)).sum();
    // ||y - w X||^2 = y'y - 2 w X y' + w X X' w' in the eigenbasis
    double residual = 0.0;
    for (Eigen::Index o = 0; o < projected.cols(); ++o) {
      const Eigen::ArrayXd b2 = projected.col(o).array().square();
      const Eigen::ArrayXd damped = lambda + beta;
      residual += std::max(0.0, squares(o) - (b2 * (lambda + 2.0 * beta) / damped.square()).sum());
    }
    const double left = samples - point.effective_parameters;
    point.score = left > 0.0
                      ? samples * residual / static_cast<double>(projected.cols()) / (left * left)
                      : std::numeric_limits<double>::infinity();
    points.push_back(point);
  }
  return points;
}

std::vector<double> LogarithmicGrid(double lower, double upper, int count) {
  if (count < 2 || !(lower > 0.0) || !(upper > lower) || !std::isfinite(upper)) {
    throw std::invalid_argument("grid: " + std::to_string(count) + " values from " +
                                std::to_string(lower) + " to " + std::to_string(upper) +
                                ", expected at least 2, 0 < lower < upper");
  }
  std::vector<double> grid;
  grid.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    grid.push_back(lower * std::pow(upper / lower, static_cast<double>(i) / (count - 1)));
  }
  return grid;
}

}  // namespace sinew::esn
