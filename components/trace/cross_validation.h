// Blocked cross-validation of candidate columns beside a base model, by sums over blocks.
//
// Blocks are dealt to folds in turn (interleaved). For each fold the base columns and a candidate's
// columns are fitted jointly to the other folds; a candidate with several nonlinear settings
// chooses its setting there, too. The score of a block is how much less squared error the candidate
// leaves than the base. The target is the residual of the base model, so that flipping the sign of
// whole blocks gives recordings with the same noise and no effect (placebo). What is flipped is the
// residual with the best candidate in the model (ter Braak 1992: Permutation versus bootstrap
// significance tests in multiple regression and ANOVA): a strong effect would be its own noise.
// Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "components/identify/block_regression.h"

namespace sinew::trace {

// A gain of this share of the left-out error is surely no noise.
inline constexpr double kClearGain = 0.2;

// Sums of one setting of a candidate, ready to be scored for any signs of the blocks.
class Setting {
 public:
  Setting(const std::vector<identify::Block>& blocks, const Eigen::Ref<const Eigen::MatrixXd>& base,
          const Eigen::Ref<const Eigen::MatrixXd>& extra,
          const Eigen::Ref<const Eigen::VectorXd>& target, int folds);

  // The same columns with another target: blocks, base and extra as given to the constructor.
  Setting Retarget(const std::vector<identify::Block>& blocks,
                   const Eigen::Ref<const Eigen::MatrixXd>& base,
                   const Eigen::Ref<const Eigen::MatrixXd>& extra,
                   const Eigen::Ref<const Eigen::VectorXd>& target) const;

  struct FoldFit {
    double train_error = 0.0;
    Eigen::VectorXd b;
  };
  // signs: +1 or -1 per block.
  FoldFit FitWithout(int fold, const Eigen::VectorXd& signs) const;
  double BlockError(std::size_t block, double sign, const Eigen::VectorXd& b) const;

  const std::vector<identify::Moments>& blocks() const { return moments_; }
  // Of all blocks.
  Eigen::VectorXd Coefficients() const;
  double SquaredError(const Eigen::VectorXd& b) const;

 private:
  int folds_;
  std::vector<identify::Moments> moments_;
  Eigen::MatrixXd scores_;                     // column per block: m
  std::vector<Eigen::MatrixXd> fold_inverse_;  // of G without the fold
  std::vector<Eigen::MatrixXd> fold_gram_;
  double yy_ = 0.0;
  std::vector<double> fold_yy_;
};

// Squared error of every block, left out once; settings compete inside the folds.
Eigen::VectorXd LeftOutErrors(const std::vector<Setting>& settings, const Eigen::VectorXd& signs,
                              int folds);

struct Gain {
  double sum = 0.0;             // of squared error, over blocks
  double standard_error = 0.0;  // of the sum, over blocks
  double t = 0.0;               // sum / standard_error
  double p = 1.0;               // one-sided, Student's t
};
Gain GainOf(const Eigen::Ref<const Eigen::VectorXd>& block_gains);

// Sums of the blocks with the extra columns (those behind the base's) joined in the proportions of
// their coefficients b: the size of the whole effect is the last coefficient, 1 on all blocks
// together.
std::vector<identify::Moments> Joined(const std::vector<identify::Moments>& blocks,
                                      const Eigen::Ref<const Eigen::VectorXd>& b,
                                      Eigen::Index base_columns);

// That size over its standard error when every block is left out once (Efron 1982: The jackknife,
// the bootstrap and other resampling plans, eq. 3.6): blocks that alone excite an effect count for
// what they are, however much blocks differ in what they gain by it.
double SizeInErrors(const std::vector<identify::Moments>& joined);

}  // namespace sinew::trace
