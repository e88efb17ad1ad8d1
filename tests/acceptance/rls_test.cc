// What recursive least squares must reach. Oracle: the batch solution; the plain recursion is known
// to leave its bounds.
#include "bench/acceptance/rls.h"

#include <gtest/gtest.h>

#include "tests/acceptance/acceptance.h"

namespace sinew::acceptance {
namespace {

TEST(RlsAcceptance, EqualsBatchLeastSquares) {
  const long updates = Quick() ? 500 : 5000;
  const BatchScore score = CompareWithBatch(updates, 1);
  EXPECT_EQ(score.updates, updates);
  EXPECT_LT(score.readout_difference, kSameAsBatch);
  EXPECT_LT(score.covariance_difference, kSameAsBatch);
}

TEST(RlsAcceptance, StaysBoundedWhereThePlainRecursionDoesNot) {
  const SoakScore score = Soak(Quick() ? 300'000 : 10'000'000, 1);
  EXPECT_TRUE(score.finite);
  EXPECT_LT(score.settled_Nm, score.noise_Nm) << "settled error, noise of a sample";
  EXPECT_LT(score.largest_eigenvalue, kMostGrowth) << "of P, in priors";
  EXPECT_GT(score.smallest_eigenvalue, 0.0);
  EXPECT_TRUE(score.bounded());
  EXPECT_GT(score.at_rest, score.updates / 2);
  EXPECT_GT(score.plain_lost_after, 0) << "the plain recursion stayed in bounds";
}

}  // namespace
}  // namespace sinew::acceptance
