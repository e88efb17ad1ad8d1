#include "components/trace/units.h"

#include <gtest/gtest.h>

#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::Signal;
using identify::SyntheticModel;
using identify::SyntheticRun;

identify::Run Periodic(double period_s, std::uint64_t seed) {
  identify::Run run = SyntheticRun(SyntheticModel(), {.rate_Hz = 100.0, .seed = seed});
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    const double w = 2.0 * M_PI / period_s;
    run.signals[Signal::kPosition][i] =
        std::sin(w * run.time_s[i]) + 0.3 * std::sin(2.0 * w * run.time_s[i]);
  }
  return run;
}

TEST(Units, APeriodicMotionIsCutIntoItsCycles) {
  const auto design = MakeDesign({Periodic(4.0, 1)}, SyntheticModel());
  EXPECT_NEAR(MotionPeriod(design), 4.0, 0.05);
  const Units units = ChooseUnits(design, 0.1, 8);
  EXPECT_EQ(units.kind, "cycle");
  EXPECT_NEAR(units.length_s, 4.0, 0.05);
  EXPECT_NEAR(static_cast<double>(units.blocks.size()), 60.0 / 4.0, 1.0);
}

TEST(Units, LongMemoryTakesWholeCycles) {
  const auto design = MakeDesign({Periodic(2.0, 1)}, SyntheticModel());
  EXPECT_NEAR(ChooseUnits(design, 1.0, 8).length_s, 6.0, 0.1);  // five correlation times, in cycles
}

TEST(Units, AnIrregularMotionIsCutIntoBlocksOfFiveCorrelationTimes) {
  const auto design =
      MakeDesign({SyntheticRun(SyntheticModel(), {.rate_Hz = 100.0})}, SyntheticModel());
  EXPECT_EQ(MotionPeriod(design), 0.0);
  const Units units = ChooseUnits(design, 0.4, 8);
  EXPECT_EQ(units.kind, "block");
  EXPECT_NEAR(units.length_s, 2.0, 1e-9);
  EXPECT_NEAR(units.gap_s, 0.2, 1e-9);
}

TEST(Units, NineRunsAreUnitsThemselvesAndEightAreCut) {
  std::vector<identify::Run> runs;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    runs.push_back(
        SyntheticRun(SyntheticModel(), {.rate_Hz = 100.0, .duration_s = 5.0, .seed = seed}));
  }
  const Units units = ChooseUnits(MakeDesign(runs, SyntheticModel()), 0.1, 8);
  EXPECT_EQ(units.kind, "run");
  EXPECT_EQ(units.blocks.size(), 9u);
  runs.pop_back();  // eight random signs are all alike once in 128 times: no 99th percentile
  EXPECT_EQ(ChooseUnits(MakeDesign(runs, SyntheticModel()), 0.1, 8).kind, "block");
}

}  // namespace
}  // namespace sinew::trace
