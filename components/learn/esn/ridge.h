// Ridge regression of a readout, and the choice of its strength by generalised cross-validation.
//
//   W_out = argmin ||Y - W_out X||^2 + beta ||W_out||^2 = Y X' (X X' + beta I)^-1 (4.41)
//
// X: features (n x T), Y: targets (O x T). All coordinates are penalised alike, the constant too,
// so the targets should have mean zero.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "components/base/simd/instructions.h"

namespace sinew::esn {

// Sums over samples, gathered sample by sample.
class NormalEquations {
 public:
  // instructions: the fastest here if not given. Throws std::invalid_argument for counts below 1,
  // or when the instruction set does not run here.
  NormalEquations(int features, int outputs, std::optional<simd::Instructions> instructions = {});

  // A sample that is not finite is refused: false.
  [[nodiscard]] bool Add(const Eigen::Ref<const Eigen::VectorXd>& features,
                         const Eigen::Ref<const Eigen::VectorXd>& target);

  int feature_count() const { return features_; }
  int output_count() const { return outputs_; }
  long samples() const { return samples_; }

  // After the last Add; more may follow.
  Eigen::MatrixXd FeatureProducts();  // X X', n x n
  Eigen::MatrixXd CrossProducts();    // X Y', n x O
  Eigen::VectorXd TargetSquares();    // diagonal of Y Y', O

 private:
  void Flush();
  double Entry(int row, int column) const;

  int features_;
  int outputs_;
  int columns_;  // features and outputs, padded
  long samples_ = 0;
  int buffered_ = 0;
  std::vector<double> panels_;  // samples waiting, as the kernel wants them
  std::vector<double> gram_;
  simd::Instructions instructions_;
};

// W_out (O x n) by Cholesky factors. Throws std::invalid_argument: beta negative or not finite, or
// the equations are not positive definite.
Eigen::MatrixXd SolveRidge(NormalEquations& equations, double beta);

struct GcvPoint {
  double beta = 0.0;
  double score = 0.0;                 // T sum_o RSS_o / (T - p)^2, mean over outputs
  double effective_parameters = 0.0;  // p = trace of the hat matrix
};

// GCV (Golub, Heath and Wahba 1979) for each beta from one eigendecomposition of X X'. The score is
// infinite where p reaches T. Throws std::invalid_argument for an empty list or a beta that is not
// positive.
std::vector<GcvPoint> GeneralisedCrossValidation(NormalEquations& equations,
                                                 const std::vector<double>& betas);

// count values from lower to upper, equal steps of their logarithm. count >= 2, 0 < lower < upper.
std::vector<double> LogarithmicGrid(double lower, double upper, int count);

}  // namespace sinew::esn
