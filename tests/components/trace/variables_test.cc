#include "components/trace/variables.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sinew::trace
