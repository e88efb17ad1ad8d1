#include "components/trace/variables.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <random>

#include "components/identify/fit.h"
#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::Signal;
using identify::SyntheticModel;
using identify::SyntheticRun;

VariableScan Scan(const identify::Run& run) {
  const auto model = SyntheticModel();
  auto design = MakeDesign({run}, model);
  const auto blocks = identify::MakeBlocks(design.rows(), 1.0, 0.1, 10);
  const auto fit = identify::FitModel(design, model, blocks);
  design.PredictDrive(fit.model);
  return ScanVariables(design, blocks, fit.balance.columns,
                       fit.balance.target - fit.balance.columns * fit.coefficients, 10, 50, 0.99,
                       1);
}

TEST(Variables, ATorqueThatBeginsPastAnAngleFollowsPosition) {
  identify::Run run = SyntheticRun(SyntheticModel(), {.noise_A = 0.05});
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    run.signals[Signal::kMotorCurrent][i] +=
        1.5 * std::max(0.0, run.At(Signal::kPosition)[i] - 0.3);
  }
  const VariableScan scan = Scan(run);
  ASSERT_FALSE(scan.scores.empty());
  EXPECT_EQ(scan.scores.front().variable, "position_rad");
  EXPECT_GT(scan.scores.front().share, 0.2);
  EXPECT_GT(scan.scores.front().share, scan.placebo_99);
}

TEST(Variables, NoiseFollowsNothing) {
  const VariableScan scan =
      Scan(SyntheticRun(SyntheticModel(), {.noise_A = 0.2, .noise_memory = 0.8}));
  ASSERT_FALSE(scan.scores.empty());
  EXPECT_LT(scan.scores.front().share, 0.05);
}

TEST(Variables, AClearCurveIsNotItsOwnNoise) {
  identify::Run run = SyntheticRun(SyntheticModel(), {.noise_A = 0.05});
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    run.signals[Signal::kMotorCurrent][i] += 0.05 * run.time_s[i];
  }
  const VariableScan scan = Scan(run);
  ASSERT_FALSE(scan.scores.empty());
  EXPECT_EQ(scan.scores.front().variable, "time_s");
  EXPECT_GT(scan.scores.front().share, 0.5);
  EXPECT_LT(scan.placebo_99, 0.1);
}

TEST(Variables, DriftIsWhatChangesAndNotWhatIsThere) {
  auto design = MakeDesign({SyntheticRun(SyntheticModel(), {})}, SyntheticModel());
  const Eigen::MatrixXd drift = DriftColumns(design);
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  const Eigen::MatrixXd X = drift(used, Eigen::all);
  const auto left_of = [&](const Eigen::VectorXd& whole) {
    const Eigen::VectorXd y = whole(used);
    const Eigen::VectorXd b = X.completeOrthogonalDecomposition().solve(y);
    return (y - X * b).squaredNorm() / y.squaredNorm();
  };
  const double end_s = design.rows().time_s[used.back()];
  EXPECT_LT(
      left_of(design.Column([&](const effects::JointSample& x) { return x.time_s / end_s - 0.5; })),
      0.05);
  EXPECT_GT(left_of(design.Column([](const effects::JointSample&) { return 1.0; })), 0.8);
}

TEST(LevelShare, StepsAreLevelsAndNoiseIsNone) {
  const auto design = MakeDesign({SyntheticRun(SyntheticModel(), {})}, SyntheticModel());
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Eigen::VectorXd noise(design.rows().size());
  for (double& value : noise) value = normal(random);
  Eigen::VectorXd steps = 0.1 * noise;
  for (Eigen::Index i = 0; i < steps.size(); ++i) {
    steps[i] +=
        design.rows().time_s[i] > 0.37 * design.rows().time_s[steps.size() - 1] ? 1.0 : -1.0;
  }
  EXPECT_LT(LevelShare(design, noise), 0.2);
  EXPECT_GT(LevelShare(design, steps), 0.9);
}

}  // namespace
}  // namespace sinew::trace
