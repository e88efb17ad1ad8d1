#include "components/model/trace/set_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "components/model/trace/null_test.h"

namespace sinew::trace {
namespace {

constexpr Eigen::Index kSceneRows = 3000;
constexpr double kNoBound = std::numeric_limits<double>::infinity();

Eigen::MatrixXd RandomColumns(Eigen::Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(kSceneRows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (double& value : out.col(c)) value = normal(random);
  }
  return out;
}

// Six columns: 0 to 4 are effects (3 and 4 two settings of one), 5 is a free curve.
struct Searched {
  Eigen::MatrixXd X = RandomColumns(2, 1), Z = RandomColumns(6, 2);
  std::vector<Hypothesis> hypotheses;
  Eigen::VectorXd y;

  explicit Searched(const Eigen::VectorXd& sizes, unsigned seed = 3)
      : y(X * Eigen::Vector2d(1.0, 2.0) + Z * sizes + RandomColumns(1, seed)) {
    const std::shared_ptr<const effects::Effect> effect = effects::MakeEffect("coulomb", {});
    for (int j = 0; j < 6; ++j) {
      Hypothesis h;
      h.name = "h" + std::to_string(j);
      h.effect = j < 5 ? effect : nullptr;
      h.columns = {j};
      h.settings = {{{}, {j}}};
      h.family = j == 4 ? 3 : j;
      h.lower = {j == 1 ? 0.0 : -kNoBound};
      h.upper = {kNoBound};
      hypotheses.push_back(std::move(h));
    }
  }
  Evidence evidence() const {
    const Prior flat{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    return Evidence(X, flat, Z, Eigen::VectorXd::Constant(6, 1e-2), y);
  }
};

Eigen::VectorXd Sizes(std::initializer_list<double> values) {
  Eigen::VectorXd out(6);
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

TEST(SetSearch, WhatIsOnlyARivalIsNotSearchedFor) {
  Searched scene(Sizes({0.5, 0.0, 0.2, 0.0, 0.0, 0.0}));
  scene.hypotheses[0].asked = Asked::kRival;
  const SetSearch found = SearchSets({scene.evidence(), scene.hypotheses}, 2, {});
  for (const EffectSet& single : found.singles) EXPECT_NE(single.members.front(), 0u);
  for (const EffectSet& best : found.best) {
    EXPECT_EQ(std::count(best.members.begin(), best.members.end(), 0u), 0);
  }
  // A set that is given holds it where there is no other of its name.
  EXPECT_EQ(FitAgreedSet({scene.evidence(), scene.hypotheses}, {"h0"}).members,
            std::vector<std::size_t>{0});
  scene.hypotheses[2].name = "h0";
  EXPECT_EQ(FitAgreedSet({scene.evidence(), scene.hypotheses}, {"h0"}).members,
            std::vector<std::size_t>{2});
}

TEST(SetSearch, TheOneEffectThatIsThereIsTheBestSingle) {
  const Searched scene(Sizes({0, 0, 0.3, 0, 0, 0}));
  const SetSearch found = SearchSets({scene.evidence(), scene.hypotheses}, 3);
  ASSERT_GE(found.best.size(), 2u);
  EXPECT_EQ(found.best[1].members, std::vector<std::size_t>{2});
  EXPECT_NEAR(found.best[1].c[0], 0.3, 0.06);
  EXPECT_LT(found.best[2].net - found.best[1].net, 15.0);
}

TEST(SetSearch, ThePairThatIsThereIsTheBestPair) {
  const Searched scene(Sizes({0.3, 0, 0, 0, 0.2, 0}));
  const SetSearch found = SearchSets({scene.evidence(), scene.hypotheses}, 3);
  std::vector<std::size_t> pair = found.best[2].members;
  std::sort(pair.begin(), pair.end());
  EXPECT_EQ(pair, (std::vector<std::size_t>{0, 4}));
}

TEST(AgreedSet, HoldsEveryNamedEffectAtTheShapeThatGainsMost) {
  Searched scene(Sizes({0.3, 0, 0, 0, 0.2, 0}));
  scene.hypotheses[0].name = scene.hypotheses[2].name = "two shapes";
  scene.hypotheses[4].name = "one shape";
  const EffectSet set =
      FitAgreedSet({scene.evidence(), scene.hypotheses}, {"one shape", "two shapes", "unknown"});
  EXPECT_EQ(set.members, (std::vector<std::size_t>{4, 0}));
  EXPECT_TRUE(FitAgreedSet({scene.evidence(), scene.hypotheses}, {}).empty());
}

TEST(SetSearch, AnEffectOfImpossibleSignIsNoSet) {
  const Searched scene(Sizes({0, -0.5, 0, 0, 0, 0}));
  const SetSearch found = SearchSets({scene.evidence(), scene.hypotheses}, 1);
  for (const EffectSet& single : found.singles) {
    EXPECT_NE(single.members.front(), 1u);
  }
}

TEST(SetSearch, SettingsOfOneEffectAreNeverInOneSet) {
  const Searched scene(Sizes({0, 0, 0, 0.4, 0.4, 0}));
  const SetSearch found = SearchSets({scene.evidence(), scene.hypotheses}, 3);
  for (const EffectSet& set : found.best) {
    int of_family = 0;
    for (const std::size_t member : set.members) of_family += member == 3 || member == 4 ? 1 : 0;
    EXPECT_LE(of_family, 1);
  }
}

TEST(SetSearch, ACurveIsFoundAloneAndBesideASet) {
  const Searched scene(Sizes({0.3, 0, 0, 0, 0, 0.4}));
  const Evidence evidence = scene.evidence();
  const SetSearch found = SearchSets({evidence, scene.hypotheses}, 1);
  EXPECT_EQ(found.curve.members, std::vector<std::size_t>{5});
  EXPECT_EQ(WithBestCurve({evidence, scene.hypotheses}, found.best[1]).members,
            (std::vector<std::size_t>{0, 5}));
}

std::vector<identify::Block> BlocksOfFifty() {
  std::vector<identify::Block> out;
  for (Eigen::Index first = 0; first < kSceneRows; first += 50) {
    out.emplace_back();
    for (Eigen::Index i = first; i < first + 50; ++i) out.back().push_back(i);
  }
  return out;
}

double PGlobal(const Searched& scene, unsigned seed) {
  const Evidence evidence = scene.evidence();
  EffectSet loudest;
  double statistic = -1e300;
  for (std::size_t h = 0; h < scene.hypotheses.size(); ++h) {
    const EffectSet single = FitSet({evidence, scene.hypotheses}, {h});
    const double own = GainStatistic(single.gain, scene.hypotheses[h]);
    if (own <= statistic) continue;
    statistic = own;
    loudest = single;
  }
  const Eigen::VectorXd noise = scene.y - scene.X * evidence.Declared(loudest.columns, loudest.c) -
                                scene.Z.col(loudest.columns.front()) * loudest.c[0];
  return NullTest(scene.X, scene.Z, noise, evidence, scene.hypotheses, {}, BlocksOfFifty(), 199,
                  seed)
      .P(statistic);
}

TEST(NullTest, APlainEffectHasTheSmallestP) {
  EXPECT_LE(PGlobal(Searched(Sizes({0, 0, 0.3, 0, 0, 0})), 1), 1.0 / 200.0);
}

TEST(NullTest, PIsUniformWithoutAnEffect) {
  constexpr int kTrials = 300;
  int below_tenth = 0, below_half = 0;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const double p = PGlobal(Searched(Sizes({0, 0, 0, 0, 0, 0}), 100 + trial), trial);
    below_tenth += p <= 0.1 ? 1 : 0;
    below_half += p <= 0.5 ? 1 : 0;
  }
  // Binomial, four standard errors: 30 +- 21 and 150 +- 35.
  EXPECT_NEAR(below_tenth, 30, 21);
  EXPECT_NEAR(below_half, 150, 35);
}

TEST(NullTest, TheLeastStatisticOfALimitReachesItAndNoSmallerOne) {
  const Searched scene(Sizes({0, 0, 0, 0, 0, 0}));
  const Evidence evidence = scene.evidence();
  const NullTest test(scene.X, scene.Z, scene.y - scene.X * evidence.Declared({}, {}), evidence,
                      scene.hypotheses, {}, BlocksOfFifty(), 199, 3);
  for (const double p : {0.01, 0.05, 0.5}) {
    EXPECT_LE(test.P(test.Least(p) + 1e-9), p);
    EXPECT_GT(test.P(test.Least(p)), p);
  }
  EXPECT_TRUE(std::isinf(test.Least(0.001)));  // 199 rounds cannot
}

TEST(NullTest, WhatIsGivenIsNoNews) {
  const Searched scene(Sizes({0, 0, 0.5, 0, 0, 0}));
  const Evidence evidence = scene.evidence();
  const EffectSet set = FitSet({evidence, scene.hypotheses}, {2});
  const Eigen::VectorXd noise =
      scene.y - scene.X * evidence.Declared(set.columns, set.c) - scene.Z.col(2) * set.c[0];
  const NullTest test(scene.X, scene.Z, noise, evidence, scene.hypotheses, {2}, BlocksOfFifty(),
                      199, 1);
  double next = -1e300;
  for (const std::size_t h : {0u, 1u, 3u, 4u, 5u}) {
    const EffectSet both = FitSet({evidence, scene.hypotheses}, {2, h});
    next = std::max(next, GainStatistic(both.gain - set.gain, scene.hypotheses[h]));
  }
  EXPECT_GT(test.P(next), 0.02);
}

}  // namespace
}  // namespace sinew::trace
