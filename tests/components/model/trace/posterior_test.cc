#include "components/model/trace/posterior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "components/model/trace/rules.h"

namespace sinew::trace {
namespace {

using ::testing::ElementsAre;

constexpr double kGain = 1000.0;

std::vector<std::string> NamesOf(const Posterior& posterior) {
  std::vector<std::string> out;
  for (const NameProbability& entry : posterior) out.push_back(entry.name);
  return out;
}

TEST(Posterior, SharesEquallyWhereNothingIsLost) {
  const Posterior found =
      PosteriorOfNames(kGain, {{"stribeck", {0.0, 2}}, {"coulomb", {0.0, 2}}}, {});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].probability, 0.5, 1e-12);
  EXPECT_NEAR(found[1].probability, 0.5, 1e-12);
}

TEST(Posterior, FallsByEForEveryLimitOfTheRuleThatIsLost) {
  const double step = rules::kShapeMisfit.limit * kGain;
  const Posterior found = PosteriorOfNames(kGain, {{"a", {0.0, 1}}, {"b", {step, 1}}}, {});
  EXPECT_NEAR(found[0].probability / found[1].probability, std::exp(1.0), 1e-9);
}

TEST(Posterior, WithoutTheRuleNoiseAloneDecides) {
  const InForce without{.without_rules = {"shape_misfit"}};
  const Posterior found = PosteriorOfNames(kGain, {{"a", {0.0, 0}}, {"b", {2.0, 0}}}, without);
  EXPECT_NEAR(found[0].probability / found[1].probability, std::exp(1.0), 1e-9);
}

TEST(Posterior, NoiseDecidesWhereTheGainIsSmall) {
  const Posterior found = PosteriorOfNames(5.0, {{"a", {0.0, 0}}, {"b", {2.0, 0}}}, {});
  EXPECT_NEAR(found[0].probability / found[1].probability, std::exp(1.0), 1e-9);
}

TEST(Posterior, PrefersFewerParametersOfTheSamePrediction) {
  const Posterior found =
      PosteriorOfNames(kGain, {{"spring", {0.0, 2}}, {"offset", {0.001 * kGain, 1}}}, {});
  EXPECT_THAT(NamesOf(found), ElementsAre("offset", "spring"));
}

TEST(Posterior, LeavesOutWhatIsImprobable) {
  const Posterior found = PosteriorOfNames(kGain, {{"a", {0.0, 1}}, {"b", {0.9 * kGain, 1}}}, {});
  EXPECT_THAT(NamesOf(found), ElementsAre("a"));
}

TEST(Posterior, NamesAsManyAsHoldNinetyPercentAndThreeAtMost) {
  EXPECT_THAT(RivalsOf({{"a", 0.95}, {"b", 0.05}}), ElementsAre());
  EXPECT_THAT(RivalsOf({{"a", 0.6}, {"b", 0.35}, {"c", 0.05}}), ElementsAre("b"));
  const Posterior many = {{"a", 0.25}, {"b", 0.25}, {"c", 0.25}, {"d", 0.25}};
  EXPECT_THAT(RivalsOf(many), ElementsAre("b", "c"));
  EXPECT_EQ(NamedCount({}), 0u);
}

TEST(Posterior, MeanKeepsTheAgreedNameFirst) {
  const Posterior mean =
      MeanPosterior("b", {{{"a", 0.7}, {"b", 0.3}}, {{"a", 0.5}, {"b", 0.4}, {"c", 0.1}}});
  EXPECT_THAT(NamesOf(mean), ElementsAre("b", "a", "c"));
  EXPECT_NEAR(mean[0].probability, 0.35, 1e-12);
  EXPECT_NEAR(mean[1].probability, 0.6, 1e-12);
  EXPECT_THAT(NamesOf(MeanPosterior("b", {})), ElementsAre("b"));
}

}  // namespace
}  // namespace sinew::trace
