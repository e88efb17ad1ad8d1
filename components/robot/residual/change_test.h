// Detects a change of a model's residual: a sequential test on blocks of it.
//
// A block is the mean over some tenth of a second: the residual y, and the columns c of everything
// that could explain it (the model's own terms, friction, an offset, a payload). No model is exact,
// so the test first learns what this one leaves, for a stated time of motion:
//
//     y = c' beta + e,   e ~ (0, s^2),   beta ~ (0, D^2)
//
// by ridge regression with the parameters' tolerances D as the prior, outliers weighted down
// (Huber). From then on every block's innovation has a known variance, and in motions that were
// not learnt it is wide, so that they are no alarm but more to learn from (recursive residuals:
// Brown, Durbin, Evans, J. R. Statist. Soc. B 37 (1975) 149, with a prior):
//
//     nu = y - c' b,   S = k s^2 + c' P c,   z = clip(nu / sqrt(S))
//
// Blocks are not independent: what the model leaves repeats with the motion. k = 1 + 2 sum of the
// positive autocorrelations of z up to the first that is not (long-run variance; Newey, West 1987,
// flat weights). It is measured, while learning and afterwards, and never taken below what was
// learnt: a spell of quiet motion does not make the test jumpy.
//
// A change of unknown size a along the column g of a cause is nu = a g from some block on.
// Generalised likelihood ratio over the last n blocks, n = 1 .. window (Willsky, Jones 1976; Lai
// 1995), less a size that is not worth an alarm (slack, as a torque):
//
//     Z = max over n and causes of ( |sum g z / sqrt(S)| - slack / rms(g) * A ) / sqrt(A),
//     A = sum g^2 / S
//
// Alarm when Z > threshold (run_length.h: the mean time without a false alarm that was asked for,
// all causes together). One block counts clip_sigmas at most: a bump alone is no change. The cause
// that is reported is the one whose column takes most of the innovations as they are (not clipped)
// from the likeliest time of change on. Above half the threshold nothing is learnt; after an alarm
// not until it has gone: Z over the whole window below half the threshold again.
//
// Thread: one. Step is noexcept; it allocates nothing but in the block that ends the learning.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace sinew::residual {

inline constexpr int kMaxColumns = 24;

struct ChangeTestConfig {
  int learn_blocks = 240;         // at least 60
  int window_blocks = 40;         // n; at least 4
  double run_length_blocks = 0.;  // mean, without change; see run_length.h
  double clip_sigmas = 5.0;
  double slack_share = 0.01;   // of the drive torque's rms while learning
  double slack_Nm = 0.0;       // at least; both: the larger
  double drift_1_block = 0.0;  // beta may wander: variance added per block, in priors squared
};

struct Column {
  double prior = 0.0;  // standard deviation of beta; 0: a quarter of the drive torque's rms over
                       // its own, while learning
  bool cause = false;  // may be reported; false: only learnt
  // False: beta stays 0. For the drive's own torque: while nothing changes it is the sum of all the
  // others, so its scale could not be learnt, and every change would pass for an error of it.
  bool learnt = true;
};

struct Block {
  double residual_Nm = 0.0;  // y
  double drive_Nm = 0.0;     // rms of the measured drive torque
  std::array<double, kMaxColumns> column{};
  bool follows_last = false;  // next to the block before in time
};

struct ChangeResult {
  bool learning = true;
  double learnt = 0.0;     // share of the learning, 0 to 1
  double statistic = 0.0;  // Z
  bool alarm = false;
  int blocks_since = 0;         // since the likeliest time of the change; 0: no alarm
  int cause = -1;               // column that the innovations follow most; -1: none above chance
  int rival = -1;               // column that takes nearly as much: 80 % of it; -1: none
  double change = 0.0;          // of that column's parameter: -a, since the residual lacks it
  double change_error = 0.0;    // standard error
  double explained = 0.0;       // share of the innovations' squares in the window that it takes
  double innovation_rms = 0.0;  // over the window
};

class ChangeTest {
 public:
  // Throws std::invalid_argument: no or too many columns, no cause, figures out of range.
  ChangeTest(const ChangeTestConfig& config, std::vector<Column> columns);

  void Reset() noexcept;
  ChangeResult Step(const Block& block) noexcept;

  double threshold() const noexcept { return threshold_; }
  // After learning: standard deviation of a block's noise, long-run (sqrt(k) s), and its k.
  double noise_Nm() const noexcept;
  double correlation() const noexcept { return correlation_; }
  double slack_Nm() const noexcept { return slack_Nm_; }
  const ChangeResult& last() const noexcept { return result_; }

 private:
  static constexpr int kLags = 12;
  struct Seen {
    double innovation = 0.0, variance = 1.0;
    std::array<double, kMaxColumns> column{};
  };

  void Learn(const Block& block) noexcept;
  void FinishLearning() noexcept;
  void Noise(const std::array<double, kLags + 1>& products) noexcept;
  void TestBlocks() noexcept;
  void Attribute(int blocks) noexcept;
  const Seen& Back(int blocks) const noexcept;

  ChangeTestConfig config_;
  std::vector<Column> columns_;
  int size_;
  double threshold_ = 0.0;

  // Learning: a row per block.
  Eigen::MatrixXd rows_;
  Eigen::VectorXd targets_, drive_;
  std::vector<char> follows_;
  int learnt_ = 0;
  Eigen::VectorXd weight_, fitted_, scaled_;
  Eigen::MatrixXd normal_;

  // beta and P in priors: column i stands for columns_[i].prior x beta_i.
  Eigen::VectorXd prior_, beta_, gain_;
  Eigen::MatrixXd covariance_;
  double learnt_variance_ = 0.0, variance_ = 0.0;  // s^2 k
  double correlation_ = 1.0;
  double slack_Nm_ = 0.0;
  std::array<double, kLags + 1> products_{};
  std::array<double, kLags> recent_{};  // standardised innovations, newest first
  int recent_count_ = 0;

  std::vector<Seen> ring_;
  int next_ = 0, seen_ = 0;
  int alarm_blocks_ = 0;  // since the alarm
  int onset_blocks_ = 0;
  ChangeResult result_;
};

}  // namespace sinew::residual
