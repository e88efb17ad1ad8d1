#include "components/robot/residual/change_test.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/robot/residual/run_length.h"

namespace sinew::residual {
namespace {

constexpr double kHuber = 2.5;  // sigmas while learning
constexpr double kTiny = 1e-12;

}  // namespace

ChangeTest::ChangeTest(const ChangeTestConfig& config, std::vector<Column> columns)
    : config_(config), columns_(std::move(columns)), size_(static_cast<int>(columns_.size())) {
  const auto causes = static_cast<int>(
      std::count_if(columns_.begin(), columns_.end(), [](const Column& c) { return c.cause; }));
  if (size_ < 1 || size_ > kMaxColumns || causes < 1) {
    throw std::invalid_argument(std::to_string(size_) + " columns with " + std::to_string(causes) +
                                " causes, expected 1 to " + std::to_string(kMaxColumns) +
                                " with at least one");
  }
  if (config_.learn_blocks < 60 || config_.window_blocks < 4 || !(config_.clip_sigmas > 1.0) ||
      !(config_.slack_share >= 0.0) || !(config_.slack_Nm >= 0.0) ||
      !(config_.drift_1_block >= 0.0)) {
    throw std::invalid_argument(
        "change test: expected at least 60 blocks to learn from, a window of at least 4, a clip "
        "above 1 sigma, and slack and drift not below 0");
  }
  threshold_ = ThresholdFor(config_.run_length_blocks, config_.window_blocks, causes);
  rows_ = Eigen::MatrixXd::Zero(config_.learn_blocks, size_);
  targets_ = drive_ = weight_ = fitted_ = Eigen::VectorXd::Zero(config_.learn_blocks);
  follows_.resize(static_cast<std::size_t>(config_.learn_blocks));
  normal_ = covariance_ = Eigen::MatrixXd::Zero(size_, size_);
  prior_ = beta_ = gain_ = scaled_ = Eigen::VectorXd::Zero(size_);
  ring_.resize(static_cast<std::size_t>(config_.window_blocks));
}

void ChangeTest::Reset() noexcept {
  learnt_ = next_ = seen_ = recent_count_ = alarm_blocks_ = onset_blocks_ = 0;
  products_ = {};
  result_ = {};
}

double ChangeTest::noise_Nm() const noexcept { return std::sqrt(variance_); }

const ChangeTest::Seen& ChangeTest::Back(int blocks) const noexcept {
  return ring_[static_cast<std::size_t>((next_ - 1 - blocks + 2 * config_.window_blocks) %
                                        config_.window_blocks)];
}

ChangeResult ChangeTest::Step(const Block& block) noexcept {
  if (result_.learning) {
    Learn(block);
    return result_;
  }
  for (int i = 0; i < size_; ++i)
    scaled_[i] = prior_[i] * block.column[static_cast<std::size_t>(i)];
  if (config_.drift_1_block > 0.0 && !result_.alarm) {
    // No wider than the prior was.
    for (int i = 0; i < size_; ++i) {
      covariance_(i, i) =
          std::max(covariance_(i, i), std::min(1.0, covariance_(i, i) + config_.drift_1_block));
    }
  }
  const double innovation = block.residual_Nm - scaled_.dot(beta_);
  gain_.noalias() = covariance_ * scaled_;
  const double variance = variance_ + scaled_.dot(gain_);
  if (!std::isfinite(innovation) || !std::isfinite(variance)) return result_;  // a broken block

  Seen& seen = ring_[static_cast<std::size_t>(next_)];
  seen.innovation = innovation;
  seen.variance = variance;
  seen.column = block.column;
  next_ = (next_ + 1) % config_.window_blocks;
  seen_ = std::min(seen_ + 1, config_.window_blocks);
  TestBlocks();

  if (result_.alarm || result_.statistic > 0.5 * threshold_) return result_;
  const double limit = config_.clip_sigmas * std::sqrt(variance);
  const double clipped = std::clamp(innovation, -limit, limit);
  beta_ += gain_ * (clipped / variance);
  for (int i = 0; i < size_; ++i) {
    for (int k = i; k < size_; ++k) {
      covariance_(i, k) -= gain_[i] * gain_[k] / variance;
      covariance_(k, i) = covariance_(i, k);
    }
  }
  // Noise: exponential memory as long as the learning.
  const double scaled = clipped * std::sqrt(variance_ / (correlation_ * variance));
  if (!block.follows_last) recent_count_ = 0;
  const double rate = 1.0 / config_.learn_blocks;
  products_[0] += rate * (scaled * scaled - products_[0]);
  for (int lag = 1; lag <= recent_count_; ++lag) {
    double& product = products_[static_cast<std::size_t>(lag)];
    product += rate * (scaled * recent_[static_cast<std::size_t>(lag - 1)] - product);
  }
  std::copy_backward(recent_.begin(), recent_.end() - 1, recent_.end());
  recent_[0] = scaled;
  recent_count_ = std::min(recent_count_ + 1, kLags);
  Noise(products_);
  return result_;
}

void ChangeTest::Learn(const Block& block) noexcept {
  double sum = block.residual_Nm + block.drive_Nm;
  for (int i = 0; i < size_; ++i) sum += block.column[static_cast<std::size_t>(i)];
  if (!std::isfinite(sum)) return;
  for (int i = 0; i < size_; ++i) rows_(learnt_, i) = block.column[static_cast<std::size_t>(i)];
  targets_[learnt_] = block.residual_Nm;
  drive_[learnt_] = block.drive_Nm;
  follows_[static_cast<std::size_t>(learnt_)] = block.follows_last;
  ++learnt_;
  result_.learnt = static_cast<double>(learnt_) / config_.learn_blocks;
  if (learnt_ == config_.learn_blocks) FinishLearning();
}

void ChangeTest::FinishLearning() noexcept {
  const double drive_rms = std::sqrt(drive_.squaredNorm() / learnt_);
  slack_Nm_ = std::max(config_.slack_Nm, config_.slack_share * drive_rms);
  for (int i = 0; i < size_; ++i) {
    const double rms = std::sqrt(rows_.col(i).squaredNorm() / learnt_);
    const double given = columns_[static_cast<std::size_t>(i)].prior;
    prior_[i] = given > 0.0 ? given : rms > kTiny ? 0.25 * drive_rms / rms : 0.0;
    if (!columns_[static_cast<std::size_t>(i)].learnt) prior_[i] = 0.0;
    rows_.col(i) *= prior_[i];
  }
  const double floor = std::max(kTiny, 1e-8 * drive_rms * drive_rms);
  weight_.setOnes();
  double variance = std::max(floor, targets_.squaredNorm() / learnt_);
  for (int round = 0; round < 12; ++round) {
    normal_.setIdentity();
    normal_.noalias() += rows_.transpose() * weight_.asDiagonal() * rows_ / variance;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(normal_);
    gain_.noalias() = rows_.transpose() * weight_.cwiseProduct(targets_) / variance;
    beta_ = solver.solve(gain_);
    covariance_.setIdentity();
    solver.solveInPlace(covariance_);
    fitted_.noalias() = targets_ - rows_ * beta_;
    double freedom = learnt_;
    double squares = 0.0;
    for (int r = 0; r < learnt_; ++r) {
      freedom -=
          weight_[r] * (rows_.row(r) * covariance_ * rows_.row(r).transpose()).value() / variance;
      const double limit = kHuber * std::sqrt(variance);
      const double size = std::abs(fitted_[r]);
      squares += std::min(size, limit) * std::min(size, limit);
      weight_[r] = size > limit ? limit / size : 1.0;
    }
    variance = std::max(floor, squares / std::max(0.25 * learnt_, freedom));
  }
  products_ = {};
  const double limit = config_.clip_sigmas * std::sqrt(variance);
  for (int lag = 0; lag <= kLags; ++lag) {
    double sum = 0.0;
    int count = 0, unbroken = 0;
    for (int r = 0; r < learnt_; ++r) {
      unbroken = r > 0 && follows_[static_cast<std::size_t>(r)] ? unbroken + 1 : 0;
      if (unbroken < lag) continue;
      sum += std::clamp(fitted_[r], -limit, limit) * std::clamp(fitted_[r - lag], -limit, limit);
      ++count;
    }
    products_[static_cast<std::size_t>(lag)] = count > 0 ? sum / count : 0.0;
  }
  products_[0] = std::max(products_[0], variance);
  learnt_variance_ = 0.0;
  Noise(products_);
  learnt_variance_ = variance_;
  // The learnt beta is known to the long-run noise, not to that of independent blocks.
  normal_.setIdentity();
  normal_.noalias() += rows_.transpose() * weight_.asDiagonal() * rows_ / variance_;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(normal_);
  covariance_.setIdentity();
  solver.solveInPlace(covariance_);
  result_.learning = false;
  result_.learnt = 1.0;
  recent_count_ = 0;
}

void ChangeTest::Noise(const std::array<double, kLags + 1>& products) noexcept {
  correlation_ = 1.0;
  for (int lag = 1; lag <= kLags; ++lag) {
    const double share = products[static_cast<std::size_t>(lag)] / std::max(kTiny, products[0]);
    if (!(share > 0.0)) break;
    correlation_ += 2.0 * share;
  }
  variance_ = std::max(learnt_variance_, correlation_ * products[0]);
}

void ChangeTest::TestBlocks() noexcept {
  double largest = 0.0;
  double whole_window = 0.0;
  int at = 0;
  for (int c = 0; c < size_; ++c) {
    if (!columns_[static_cast<std::size_t>(c)].cause) continue;
    double score = 0.0, information = 0.0, squares = 0.0;
    for (int n = 1; n <= seen_; ++n) {
      const Seen& seen = Back(n - 1);
      const double g = seen.column[static_cast<std::size_t>(c)];
      const double limit = config_.clip_sigmas * std::sqrt(seen.variance);
      score += g * std::clamp(seen.innovation, -limit, limit) / seen.variance;
      information += g * g / seen.variance;
      squares += g * g;
      if (!(information > kTiny) || !(squares > kTiny)) continue;
      const double slack = slack_Nm_ / std::sqrt(squares / n);
      const double z = (std::abs(score) - slack * information) / std::sqrt(information);
      if (z > largest) {
        largest = z;
        at = n;
      }
      whole_window = std::max(whole_window, n == config_.window_blocks ? z : 0.0);
    }
  }
  result_.statistic = largest;
  if (!result_.alarm && largest > threshold_) {
    result_.alarm = true;
    alarm_blocks_ = 0;
    onset_blocks_ = at;
  } else if (result_.alarm) {
    ++alarm_blocks_;
    ++onset_blocks_;
    if (alarm_blocks_ >= config_.window_blocks && largest < 0.5 * threshold_ &&
        whole_window < 0.5 * threshold_) {
      result_.alarm = false;
    }
  }
  result_.blocks_since = result_.alarm ? onset_blocks_ : 0;
  Attribute(result_.alarm ? std::min(onset_blocks_, seen_) : seen_);
}

void ChangeTest::Attribute(int blocks) noexcept {
  // The change came somewhere in the first block of its window and shook the joint in the next.
  if (result_.alarm && onset_blocks_ <= seen_ && blocks > 4) blocks -= 2;
  double squares = 0.0, sum = 0.0;
  for (int n = 0; n < blocks; ++n) {
    const Seen& seen = Back(n);
    squares += seen.innovation * seen.innovation / seen.variance;
    sum += seen.innovation * seen.innovation;
  }
  result_.innovation_rms = blocks > 0 ? std::sqrt(sum / blocks) : 0.0;
  result_.cause = result_.rival = -1;
  result_.change = result_.change_error = result_.explained = 0.0;
  constexpr double kNothing = 9.0;  // three standard errors, or it follows nothing
  double most = kNothing, second = 0.0;
  for (int c = 0; c < size_; ++c) {
    if (!columns_[static_cast<std::size_t>(c)].cause) continue;
    double score = 0.0, information = 0.0;
    for (int n = 0; n < blocks; ++n) {
      const Seen& seen = Back(n);
      const double g = seen.column[static_cast<std::size_t>(c)];
      score += g * seen.innovation / seen.variance;
      information += g * g / seen.variance;
    }
    if (!(information > kTiny)) continue;
    const double taken = score * score / information;
    if (taken > most) {
      second = most;
      result_.rival = result_.cause;
      most = taken;
      result_.cause = c;
      result_.change = -score / information;  // what is missing makes the residual's opposite
      result_.change_error = 1.0 / std::sqrt(information);
      result_.explained = taken / squares;
    } else if (taken > std::max(second, kNothing)) {
      second = taken;
      result_.rival = c;
    }
  }
  if (second < 0.8 * most) result_.rival = -1;
}

}  // namespace sinew::residual
