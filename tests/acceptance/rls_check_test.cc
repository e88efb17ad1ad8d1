// Oracle: the batch solution; the plain recursion is known to leave its bounds.
#include "tools/acceptance/rls_check.h"

#include <gtest/gtest.h>

namespace sinew::check {
namespace {

TEST(RlsCheck, EqualsBatchLeastSquares) {
  const BatchScore score = CompareWithBatch(300, 1);
  EXPECT_EQ(score.updates, 300);
  EXPECT_LT(score.readout_difference, 1e-9);
  EXPECT_LT(score.covariance_difference, 1e-9);
}

TEST(RlsCheck, StaysBoundedWhereThePlainRecursionDoesNot) {
  const SoakScore score = Soak(80000, 1);
  EXPECT_TRUE(score.bounded()) << score.settled_Nm << " Nm, " << score.largest_eigenvalue;
  EXPECT_GT(score.at_rest, score.updates / 2);
  EXPECT_GT(score.plain_lost_after, 0);
}

TEST(RlsSection, TellsWhatIsReachedAndWhatIsMissed) {
  BatchScore batch{.updates = 1, .readout_difference = 1e-12, .covariance_difference = 1e-12};
  SoakScore soak;
  soak.updates = 10;
  soak.noise_Nm = 1.0;
  soak.smallest_eigenvalue = 0.1;
  soak.largest_eigenvalue = 1.0;
  TimeScore time{.features = 76, .outputs = 12, .update_us = 1.7, .textbook_us = 3.0};
  report::Section section = MakeRlsSection(batch, soak, {time});
  report::CheckSection(section);
  for (const report::Comparison& line : section.comparisons) {
    EXPECT_TRUE(line.met.value_or(true)) << line.name;
  }
  batch.readout_difference = batch.covariance_difference = 1e-6;
  soak.largest_eigenvalue = 3.0;
  time.update_us = 1.9;
  for (const report::Comparison& line : MakeRlsSection(batch, soak, {time}).comparisons) {
    EXPECT_FALSE(line.met.value_or(false)) << line.name;
  }
}

}  // namespace
}  // namespace sinew::check
