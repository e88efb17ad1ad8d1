#include "components/trace/ceiling.h"

#include <gtest/gtest.h>

#include "components/identify/fit.h"
#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::SyntheticModel;
using identify::SyntheticRun;

TEST(Ceiling, ScatterOfTheDriveGivesTheFloorOfWhiteNoise) {
  const auto model = SyntheticModel();
  const auto design = MakeDesign({SyntheticRun(model, {.noise_A = 0.1})}, model);
  const auto balance = identify::MakeBalance(design, model);
  const NoiseFloor floor = EstimateNoiseFloor(design, balance, 0.8);
  EXPECT_EQ(floor.source, "sample-to-sample scatter");
  // 0.1 A * 50 * 0.02 Nm/A * 0.8, of which 8 of 100 Hz pass.
  const double expected = 0.1 * 50 * 0.02 * 0.8 * std::sqrt(0.08);
  EXPECT_NEAR(floor.rms, expected, 0.2 * expected);
}

TEST(Ceiling, AFlexibleModelPredictsWhatHasAShapeAndNotNoise) {
  auto model = SyntheticModel();
  auto truth = model;
  truth.terms.push_back(identify::TermOf("quadratic_viscous", {0.4}, model.constants));
  for (const bool shaped : {true, false}) {
    const auto design =
        MakeDesign({SyntheticRun(shaped ? truth : model, {.noise_A = 0.05})}, model);
    const auto blocks = identify::MakeBlocks(design.rows(), 1.0, 0.1, 10);
    const auto fit = identify::FitModel(design, model, blocks);
    const FlexibleFit flexible =
        FitFlexible(blocks, fit.balance.columns, FlexibleColumns(design, 80, 1),
                    fit.balance.target - fit.balance.columns * fit.coefficients, 10);
    if (shaped) {
      EXPECT_GT(flexible.left_out_share, 0.5);
    } else {
      EXPECT_LT(flexible.left_out_share, 0.05);
    }
  }
}

}  // namespace
}  // namespace sinew::trace
