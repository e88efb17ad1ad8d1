#include "components/trace/cross_validation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/identify/statistics.h"

namespace sinew::trace {

Setting::Setting(const std::vector<identify::Block>& blocks,
                 const Eigen::Ref<const Eigen::MatrixXd>& base,
                 const Eigen::Ref<const Eigen::MatrixXd>& extra,
                 const Eigen::Ref<const Eigen::VectorXd>& target, int folds)
    : folds_(folds) {
  Eigen::MatrixXd X(base.rows(), base.cols() + extra.cols());
  X << base, extra;
  const Eigen::Index p = X.cols();
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(p, p);
  scores_.resize(p, static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    moments_.push_back(identify::MomentsOf(blocks[b], X, target));
    total += moments_.back().G;
    scores_.col(static_cast<Eigen::Index>(b)) = moments_.back().m;
    yy_ += moments_.back().yy;
  }
  for (int f = 0; f < folds; ++f) {
    Eigen::MatrixXd rest = total;
    double yy = yy_;
    for (std::size_t b = static_cast<std::size_t>(f); b < blocks.size();
         b += static_cast<std::size_t>(folds)) {
      rest -= moments_[b].G;
      yy -= moments_[b].yy;
    }
    fold_inverse_.push_back(identify::Inverse(rest));
    fold_gram_.push_back(std::move(rest));
    fold_yy_.push_back(yy);
  }
}

Setting Setting::Retarget(const std::vector<identify::Block>& blocks,
                          const Eigen::Ref<const Eigen::MatrixXd>& base,
                          const Eigen::Ref<const Eigen::MatrixXd>& extra,
                          const Eigen::Ref<const Eigen::VectorXd>& target) const {
  Setting out = *this;
  out.yy_ = 0.0;
  std::fill(out.fold_yy_.begin(), out.fold_yy_.end(), 0.0);
  const Eigen::Index k = base.cols();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    identify::Moments& sums = out.moments_[b];
    sums.m.setZero();
    sums.yy = 0.0;
    for (const Eigen::Index i : blocks[b]) {
      sums.m.head(k) += target[i] * base.row(i).transpose();
      sums.m.tail(extra.cols()) += target[i] * extra.row(i).transpose();
      sums.yy += target[i] * target[i];
    }
    out.scores_.col(static_cast<Eigen::Index>(b)) = sums.m;
    out.yy_ += sums.yy;
  }
  for (std::size_t f = 0; f < out.fold_yy_.size(); ++f) {
    out.fold_yy_[f] = out.yy_;
    for (std::size_t b = f; b < blocks.size(); b += out.fold_yy_.size()) {
      out.fold_yy_[f] -= out.moments_[b].yy;
    }
  }
  return out;
}

Setting::FoldFit Setting::FitWithout(int fold, const Eigen::VectorXd& signs) const {
  Eigen::VectorXd m = Eigen::VectorXd::Zero(scores_.rows());
  for (Eigen::Index b = 0; b < scores_.cols(); ++b) {
    if (b % folds_ != fold) m += signs[b] * scores_.col(b);
  }
  const auto f = static_cast<std::size_t>(fold);
  FoldFit out;
  out.b = fold_inverse_[f] * m;
  out.train_error = fold_yy_[f] - 2.0 * out.b.dot(m) + out.b.dot(fold_gram_[f] * out.b);
  return out;
}

double Setting::BlockError(std::size_t block, double sign, const Eigen::VectorXd& b) const {
  const identify::Moments& sums = moments_[block];
  return sums.yy - 2.0 * sign * b.dot(sums.m) + b.dot(sums.G * b);
}

Eigen::VectorXd Setting::Coefficients() const {
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(scores_.rows(), scores_.rows());
  for (const identify::Moments& block : moments_) total += block.G;
  return identify::Solve(total, scores_.rowwise().sum());
}

double Setting::SquaredError(const Eigen::VectorXd& b) const {
  double error = 0.0;
  for (const identify::Moments& block : moments_) error += block.SquaredError(b);
  return error;
}

Eigen::VectorXd LeftOutErrors(const std::vector<Setting>& settings, const Eigen::VectorXd& signs,
                              int folds) {
  const Eigen::Index count = signs.size();
  Eigen::VectorXd errors(count);
  for (int f = 0; f < folds; ++f) {
    const Setting* best = nullptr;
    Setting::FoldFit fit;
    double least = std::numeric_limits<double>::infinity();
    for (const Setting& setting : settings) {
      Setting::FoldFit trial = setting.FitWithout(f, signs);
      if (trial.train_error < least || best == nullptr) {
        least = trial.train_error;
        best = &setting;
        fit = std::move(trial);
      }
    }
    for (Eigen::Index b = f; b < count; b += folds) {
      errors[b] = best->BlockError(static_cast<std::size_t>(b), signs[b], fit.b);
    }
  }
  return errors;
}

Gain GainOf(const Eigen::Ref<const Eigen::VectorXd>& block_gains) {
  const double n = static_cast<double>(block_gains.size());
  Gain out;
  out.sum = block_gains.sum();
  if (n < 2.0) return out;
  const double mean = out.sum / n;
  const double variance = (block_gains.array() - mean).square().sum() / (n - 1.0);
  out.standard_error = std::sqrt(n * variance);
  if (out.standard_error > 0.0) {
    out.t = out.sum / out.standard_error;
    out.p = identify::StudentCdf(-out.t, n - 1.0);
  }
  return out;
}

std::vector<identify::Moments> Joined(const std::vector<identify::Moments>& blocks,
                                      const Eigen::Ref<const Eigen::VectorXd>& b,
                                      Eigen::Index base_columns) {
  Eigen::MatrixXd join = Eigen::MatrixXd::Zero(b.size(), base_columns + 1);
  join.topLeftCorner(base_columns, base_columns).setIdentity();
  join.col(base_columns).tail(b.size() - base_columns) = b.tail(b.size() - base_columns);
  std::vector<identify::Moments> out;
  out.reserve(blocks.size());
  for (const identify::Moments& block : blocks) {
    out.push_back({.G = join.transpose() * block.G * join,
                   .m = join.transpose() * block.m,
                   .yy = block.yy,
                   .rows = block.rows});
  }
  return out;
}

double SizeInErrors(const std::vector<identify::Moments>& joined) {
  const Eigen::Index p = joined.front().G.cols();
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd m = Eigen::VectorXd::Zero(p);
  for (const identify::Moments& block : joined) {
    G += block.G;
    m += block.m;
  }
  const double size = identify::Solve(G, m)[p - 1];
  double squares = 0.0;
  for (const identify::Moments& block : joined) {
    const double without = identify::Solve(G - block.G, m - block.m)[p - 1];
    squares += (without - size) * (without - size);
  }
  return size / std::sqrt(squares * (1.0 - 1.0 / static_cast<double>(joined.size())));
}

}  // namespace sinew::trace
