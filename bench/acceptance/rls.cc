#include "bench/acceptance/rls.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "components/learn/rls/rls.h"

namespace sinew::acceptance {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double Next() { return normal_(bits_); }
  Eigen::VectorXd Vector(Eigen::Index n) {
    return Eigen::VectorXd::NullaryExpr(n, [this] { return Next(); });
  }
  Eigen::MatrixXd Matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [this] { return Next(); });
  }

 private:
  std::mt19937_64 bits_;
  std::normal_distribution<double> normal_;
};

// Smooth features of a squat: some are nearly multiples of each other, as a reservoir's are.
Eigen::VectorXd Features(int count, double phase) {
  Eigen::VectorXd phi(count);
  const double squat = 0.5 * (1.0 - std::cos(phase));
  for (int i = 0; i < count; ++i) {
    phi(i) = std::tanh(0.8 * squat * std::cos(0.7 * i) +
                       0.3 * std::sin(phase + 0.37 * i) * std::sin(0.9 * i) + 0.1 * std::sin(i));
  }
  phi(0) = 1.0;
  return phi;
}

}  // namespace

BatchScore CompareWithBatch(long updates, std::uint64_t seed) {
  constexpr int kFeatures = 76, kOutputs = 12;
  Random random(seed);
  rls::Config config;
  config.forgetting = 1.0;
  config.leak = 0.0;
  config.clip_sigmas = 0.0;
  const Eigen::MatrixXd offline = random.Matrix(kOutputs, kFeatures);
  rls::RecursiveLeastSquares rls(config, offline);
  Eigen::MatrixXd information =
      config.prior_precision * Eigen::MatrixXd::Identity(kFeatures, kFeatures);
  Eigen::MatrixXd right = config.prior_precision * offline;
  for (long t = 0; t < updates; ++t) {
    const Eigen::VectorXd phi = random.Vector(kFeatures);
    const Eigen::VectorXd y = random.Vector(kOutputs);
    if (rls.Update(phi, y) != rls::UpdateStatus::kOk) break;
    information += phi * phi.transpose();
    right += y * phi.transpose();
  }
  const Eigen::MatrixXd expected = information.ldlt().solve(right.transpose()).transpose();
  const Eigen::MatrixXd covariance = information.inverse();
  return {static_cast<long>(rls.updates()),
          (Eigen::MatrixXd(rls.readout()) - expected).norm() / expected.norm(),
          (rls.Covariance() - covariance).norm() / covariance.norm()};
}

bool SoakScore::bounded() const {
  return finite && settled_Nm < noise_Nm && largest_eigenvalue < kMostGrowth &&
         smallest_eigenvalue > 0.0;
}

SoakScore Soak(long updates, std::uint64_t seed) {
  constexpr int kFeatures = 77, kOutputs = 12;
  constexpr long kMoving = 4000, kCycle = 14000, kChange = 60000;
  constexpr double kNoise_Nm = 0.01;
  Random random(seed);
  Eigen::MatrixXd features(kFeatures, kMoving);
  for (long t = 0; t < kMoving; ++t) {
    features.col(t) = Features(kFeatures, 2.0 * std::numbers::pi * static_cast<double>(t) / 2000.0);
  }
  const Eigen::MatrixXd offline = random.Matrix(kOutputs, kFeatures) / std::sqrt(kFeatures);
  const Eigen::MatrixXd change = 0.2 * random.Matrix(kOutputs, kFeatures) / std::sqrt(kFeatures);
  const rls::Config config;
  rls::RecursiveLeastSquares rls(config, offline);
  SoakScore score;
  score.noise_Nm = kNoise_Nm;
  double settled = 0.0;
  long settled_count = 0;
  Eigen::VectorXd y(kOutputs);
  const long look = std::max(updates / 20, 1L);
  for (long t = 0; t < updates && score.finite; ++t) {
    const auto phi = features.col(std::min(t % kCycle, kMoving - 1));
    score.at_rest += t % kCycle >= kMoving;
    y.noalias() = offline * phi;
    if ((t / kChange) % 2 == 1) y.noalias() += change * phi;
    const double error = (y - rls.readout() * phi).squaredNorm() / kOutputs;
    for (int o = 0; o < kOutputs; ++o) y(o) += kNoise_Nm * random.Next();
    score.finite = rls.Update(phi, y) != rls::UpdateStatus::kBadInput && std::isfinite(error);
    ++score.updates;
    if (t > kChange && t % kChange > kChange / 2) {
      settled += error;
      ++settled_count;
    }
    if (t % look == look - 1) {
      const Eigen::VectorXd eigen =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(rls.Covariance()).eigenvalues() *
          config.prior_precision;
      score.largest_eigenvalue = std::max(score.largest_eigenvalue, eigen.maxCoeff());
      score.smallest_eigenvalue = score.smallest_eigenvalue == 0.0
                                      ? eigen.minCoeff()
                                      : std::min(score.smallest_eigenvalue, eigen.minCoeff());
    }
  }
  score.settled_Nm = std::sqrt(settled / static_cast<double>(std::max(settled_count, 1L)));

  // The plain recursion, as the control of this experiment.
  Eigen::MatrixXd p = Eigen::MatrixXd::Identity(kFeatures, kFeatures) / config.prior_precision;
  for (long t = 0; t < std::min(updates, 60000L); ++t) {
    const auto phi = features.col(std::min(t % kCycle, kMoving - 1));
    const Eigen::VectorXd g = p * phi;
    const Eigen::VectorXd k = g / (config.forgetting + phi.dot(g));
    p = ((p - k * g.transpose()) / config.forgetting).eval();
    const bool grown = !(p.trace() * config.prior_precision < 1e6 * kFeatures);
    if (grown || p.diagonal().minCoeff() <= 0.0) {
      score.plain_lost_after = t + 1;
      break;
    }
  }
  return score;
}

TimeScore TimeUpdates(int features, int outputs) {
  using Clock = std::chrono::steady_clock;
  constexpr int kBatches = 200, kBatch = 200;
  Random random(1);
  const Eigen::MatrixXd phi = random.Matrix(features, 512);
  const Eigen::VectorXd y = Eigen::VectorXd::Constant(outputs, 0.3);
  const auto time = [&](const auto& update) {
    std::vector<double> batches_us;
    long t = 0;
    for (int b = 0; b < kBatches; ++b) {
      const auto start = Clock::now();
      for (int i = 0; i < kBatch; ++i) update(t++ & 511);
      batches_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count() /
                           kBatch);
    }
    std::sort(batches_us.begin(), batches_us.end());
    return std::pair{batches_us.front(), batches_us[kBatches / 2]};
  };
  TimeScore score;
  score.features = features;
  score.outputs = outputs;
  rls::RecursiveLeastSquares rls(rls::Config{}, Eigen::MatrixXd::Zero(outputs, features));
  std::tie(score.update_us, score.median_us) =
      time([&](long t) { static_cast<void>(rls.Update(phi.col(t), y)); });
  Eigen::MatrixXd p = Eigen::MatrixXd::Identity(features, features);
  Eigen::MatrixXd w = Eigen::MatrixXd::Zero(outputs, features);
  Eigen::VectorXd g(features), e(outputs);
  score.textbook_us = time([&](long t) {
                        const auto x = phi.col(t);
                        g.noalias() = p * x;
                        const double gain = 1.0 / (0.999 + x.dot(g));
                        e.noalias() = y - w * x;
                        w.noalias() += (gain * e) * g.transpose();
                        p.noalias() -= (gain * g) * g.transpose();
                        p *= 1.0 / 0.999;
                      }).first;
  return score;
}

}  // namespace sinew::acceptance
