// Ten million updates, of which most are at rest: 76 neurons move for 4000 samples, then stand for
// 10000, again and again; the truth changes and changes back. Prints the errors and the covariance;
// exit code 1 when anything left its bounds. About half a minute.
//   build/release/bin/rls_soak [updates] [--directional]
// --directional: forgetting, leak and prior of robots/biped/rls.yaml.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>

#include "components/learn/esn/network.h"
#include "components/learn/rls/rls.h"

namespace {

using namespace sinew;

constexpr int kOutputs = 12;
constexpr int kInputs = 18;
constexpr long kMoving = 4000;
constexpr long kCycle = 14000;
constexpr long kChange = 60000;
constexpr double kNoise_Nm = 0.01;

// Features along a squat of 2000 samples, settled; without columns: a step failed.
Eigen::MatrixXd Features() {
  esn::Hyperparameters hyper;
  hyper.neurons = 76;
  hyper.leak = 0.5;
  hyper.spectral_radius = 0.9;
  esn::Weights weights = esn::MakeWeights(hyper, kInputs, kOutputs);
  weights.period_s = 1.0 / 240.0;
  esn::Network network(weights);
  Eigen::MatrixXd features(weights.feature_count(), kMoving);
  for (int pass = 0; pass < 2; ++pass) {
    for (long t = 0; t < kMoving; ++t) {
      const double squat =
          0.5 * (1.0 - std::cos(2.0 * 3.14159265358979 * static_cast<double>(t) / 2000.0));
      Eigen::VectorXd u(kInputs);
      for (int m = 0; m < kInputs; ++m) u(m) = squat * std::cos(0.7 * m) + 0.1 * std::sin(m);
      if (network.Step(u) != esn::StepStatus::kOk) return {};
      features.col(t) = network.features();
    }
  }
  return features;
}

}  // namespace

int main(int argc, char** argv) {
  long updates = 10'000'000;
  rls::Config config;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--directional") {
      config.directional = true;
      config.forgetting = 0.993;
      config.leak = 0.02;
      config.prior_precision = 700.0;
    } else {
      updates = std::atol(argv[i]);
    }
  }
  const Eigen::MatrixXd features = Features();
  if (features.cols() == 0) return 1;
  const auto n = static_cast<int>(features.rows());

  std::mt19937_64 bits(1);
  std::normal_distribution<double> normal;
  const auto random = [&](double scale) {
    Eigen::MatrixXd m(kOutputs, n);
    for (Eigen::Index i = 0; i < m.size(); ++i) m.data()[i] = scale * normal(bits) / std::sqrt(n);
    return m;
  };
  const Eigen::MatrixXd offline = random(1.0);
  const Eigen::MatrixXd change = random(0.2);
  rls::RecursiveLeastSquares rls(config, offline);
  double settled = 0.0;
  long settled_count = 0;
  double worst = 0.0;
  double largest = 0.0;
  double smallest_relative = 1.0;
  Eigen::VectorXd y(kOutputs);
  for (long t = 0; t < updates; ++t) {
    const Eigen::VectorXd phi = features.col(std::min(t % kCycle, kMoving - 1));
    y = offline * phi;
    if ((t / kChange) % 2 == 1) y += change * phi;
    const Eigen::VectorXd truth = y;
    const double error = (truth - rls.readout() * phi).squaredNorm() / kOutputs;
    for (int o = 0; o < kOutputs; ++o) y(o) += kNoise_Nm * normal(bits);
    if (rls.Update(phi, y) == rls::UpdateStatus::kBadInput || !std::isfinite(error)) {
      std::printf("update %ld: not finite\n", t);
      return 1;
    }
    if (t > kChange) worst = std::max(worst, std::sqrt(error));
    if (t > kChange && t % kChange > kChange / 2) {
      settled += error;
      ++settled_count;
    }
    if (t % (updates / 20 + 1) == 0) {
      const Eigen::VectorXd eigen =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(rls.Covariance()).eigenvalues();
      largest = std::max(largest, eigen.maxCoeff());
      smallest_relative = std::min(smallest_relative, eigen.minCoeff() / eigen.maxCoeff());
    }
  }
  const double settled_Nm = std::sqrt(settled / static_cast<double>(std::max(settled_count, 1L)));
  std::printf("%ld updates, %d features, %d outputs\n", updates, n, kOutputs);
  std::printf("settled error %.5f Nm rms (noise of a sample %.3f), worst %.3f Nm\n", settled_Nm,
              kNoise_Nm, worst);
  std::printf(
      "largest eigenvalue of P %.4g (prior %.4g), smallest / largest %.3g, clipped %.3f %%\n",
      largest, 1.0 / config.prior_precision, smallest_relative,
      100.0 * static_cast<double>(rls.clipped()) / static_cast<double>(rls.updates()));
  const bool good =
      settled_Nm < kNoise_Nm && largest < 2.0 / config.prior_precision && smallest_relative > 0.0;
  std::printf("%s\n", good ? "bounded" : "OUT OF BOUNDS");
  return good ? 0 : 1;
}
