#include <gtest/gtest.h>

#include "components/model/trace/reported.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::SyntheticModel;
using identify::SyntheticRun;

TEST(NoiseFloor, ScatterOfTheDriveGivesTheFloorOfWhiteNoise) {
  const auto model = SyntheticModel();
  const auto design = MakeDesign({SyntheticRun(model, {.noise_A = 0.1})}, model);
  const auto balance = identify::MakeBalance(design, model);
  const NoiseFloor floor = EstimateNoiseFloor(design, balance, 0.8);
  EXPECT_EQ(floor.source, "sample-to-sample scatter");
  // 0.1 A * 50 * 0.02 Nm/A * 0.8, of which 8 of 100 Hz pass.
  const double expected = 0.1 * 50 * 0.02 * 0.8 * std::sqrt(0.08);
  EXPECT_NEAR(floor.rms, expected, 0.2 * expected);
}

}  // namespace
}  // namespace sinew::trace
