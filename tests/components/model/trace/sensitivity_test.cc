// The size reported as detectable is found about as often as its stated power.
#include "components/model/trace/sensitivity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>

#include "components/model/trace/likelihood_tracer.h"
#include "components/model/trace/null_test.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

Hypothesis OfColumns(int columns, double searched) {
  Hypothesis out;
  for (int j = 0; j < columns; ++j) out.columns.push_back(j);
  out.charge = searched;
  return out;
}

TEST(Detectable, TheGainOfAStatisticIsItsInverse) {
  for (const int columns : {1, 2, 5}) {
    for (const double searched : {0.0, 3.0}) {
      const Hypothesis h = OfColumns(columns, searched);
      for (const double gain : {5.0, 30.0, 400.0}) {
        EXPECT_NEAR(GainOfStatistic(GainStatistic(gain, h), h), gain, 1e-9 * gain);
      }
    }
  }
}

TEST(Detectable, BothRulesAreAsked) {
  const Hypothesis h = OfColumns(1, 0.0);
  const double share = rules::kExplainedShare.limit;
  // A long recording is ruled by the share: what is left of the gain after its charge, of the
  // misfit with the effect in it.
  constexpr double kNever = std::numeric_limits<double>::infinity();
  constexpr double kOccam = 9.0;
  const double gain = NeededGain(h, 1e5, kOccam, 3.0, kNever, {});
  EXPECT_NEAR(gain - kOccam, share * (1e5 + gain), 1e-6 * gain);
  // A short one by the p of the whole search.
  EXPECT_DOUBLE_EQ(NeededGain(h, 100.0, kOccam, 5.0, kNever, {}), GainOfStatistic(5.0, h));
  // Where noise is coloured, less of the misfit is enough.
  EXPECT_DOUBLE_EQ(NeededGain(h, 1e5, kOccam, 3.0, 500.0, {}), 500.0);
}

// Share of draws in which k columns, one of them with an effect of that size beside something else,
// gain what is needed, and the effect has its sign.
double ShareAbove(double needed, int columns, double size, double other) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  int above = 0;
  const int draws = 20000;
  for (int i = 0; i < draws; ++i) {
    const double seen = size + (i % 2 == 0 ? other : -other);
    double gain = 0.0;
    for (int j = 0; j < columns; ++j) {
      const double c = normal(random) + (j == 0 ? seen : 0.0);
      gain += c * c;
    }
    above += gain >= needed && seen > 0.0 ? 1 : 0;
  }
  return static_cast<double>(above) / draws;
}

TEST(Detectable, FourOfFiveRecordingsReachTheGainThatIsNeeded) {
  // Of the normal approximation: worse where half of the draws have to make up for the others.
  const auto approximation = [](double other) { return other > 0.5 ? 0.03 : 0.02; };
  for (const int columns : {1, 2, 4}) {
    for (const double needed : {15.0, 60.0, 500.0}) {
      for (const double other : {0.0, 0.5, 3.0, 40.0}) {
        const double size = SizeForPower(needed, columns, other);
        EXPECT_NEAR(ShareAbove(needed, columns, size, other), 0.8, approximation(other))
            << columns << " columns, " << needed << ", beside " << other;
      }
    }
  }
}

TraceResult TraceDrag(double drag, std::uint64_t seed) {
  const actuator::JointModel model = identify::SyntheticModel();
  actuator::JointModel truth = model;
  truth.terms.push_back(identify::TermOf("quadratic_viscous", {drag}, truth.constants));
  const auto design = [&](std::uint64_t of, const identify::ProcessingOptions* options) {
    const types::Run run = identify::SyntheticRun(
        truth, {.rate_Hz = 100.0, .duration_s = 40.0, .seed = of, .noise_A = 0.1});
    const identify::ProcessingOptions own =
        options == nullptr ? identify::FromMotion({run}, model, 0.25) : *options;
    return identify::Design(identify::MakeStates({run}, model, own), own);
  };
  identify::Design train = design(seed, nullptr);
  identify::Design held_out = design(seed + 1000, &train.options());
  return TraceByLikelihood(train, held_out, model, {});
}

bool FindsDrag(const TraceResult& result) {
  for (const CandidateScore& score : result.scores) {
    if (score.name == "quadratic_viscous") {
      return score.accepted || (score.refused.rule != rules::kGlobalP.id &&
                                score.refused.rule != rules::kEvidence.id &&
                                score.refused.rule != rules::kExplainedShare.id);
    }
  }
  return false;
}

TEST(Detectable, TheSearchFindsWhatItSaysItFinds) {
  const TraceResult clean = TraceDrag(0.0, 1);
  double size = 0.0;
  for (const DetectableSize& at : clean.detectable) {
    if (at.effect != "quadratic_viscous") continue;
    size = at.size;
    EXPECT_EQ(at.parameter, "quadratic_Nm_s2_rad2");
    EXPECT_EQ(at.unit, "Nm_s2_rad2");
    EXPECT_TRUE(at.shape.empty());
  }
  ASSERT_GT(size, 0.0);
  int found = 0, found_weak = 0;
  for (std::uint64_t seed = 2; seed < 7; ++seed) {
    found += FindsDrag(TraceDrag(1.5 * size, seed)) ? 1 : 0;
    found_weak += FindsDrag(TraceDrag(0.4 * size, seed)) ? 1 : 0;
  }
  EXPECT_GE(found, 4);
  EXPECT_LE(found_weak, 1);
}

TEST(Detectable, WhatIsFoundDoesNotHideAndWhatOnlyResemblesItMay) {
  const TraceResult result = TraceDrag(0.5, 8);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  std::set<std::string> hidden;
  for (const NotExcited& effect : result.not_excited) hidden.insert(effect.effect);
  const std::set<std::string> assessed(result.assessed.begin(), result.assessed.end());
  for (const FoundEffect& found : result.effects) {
    EXPECT_EQ(hidden.count(found.name), 0u) << found.name;
    EXPECT_EQ(assessed.count(found.name), 1u) << found.name;
  }
  // Twenty standard deviations, all of them the drag's: beside it each is in one of the lists.
  int resembling = 0;
  for (const CandidateScore& score : result.scores) {
    if (score.statistic < 20.0 || score.accepted) continue;
    ++resembling;
    EXPECT_EQ(hidden.count(score.name) + assessed.count(score.name), 1u) << score.name;
  }
  EXPECT_GT(resembling, 0);
  EXPECT_GT(hidden.size(), 0u);
}

// A size that matters to the torque, or that machines have, has to be one that would be found.
TEST(Detectable, WhatHidesIsLargerThanMattersOrThanMachinesHaveIt) {
  const TraceResult result = TraceDrag(0.0, 1);
  std::map<std::string, double> hides;  // of each effect's most visible parameter
  for (const DetectableSize& size : result.detectable) {
    const double one = std::max(size.share / 0.01, size.of_expected);
    const auto [at, fresh] = hides.try_emplace(size.effect, one);
    if (!fresh) at->second = std::min(at->second, one);
  }
  ASSERT_FALSE(hides.empty());
  for (const std::string& name : result.assessed) {
    if (hides.contains(name)) EXPECT_LE(hides.at(name), 1.0) << name;
  }
  int by_size = 0;
  for (const NotExcited& effect : result.not_excited) {
    if (!hides.contains(effect.effect)) continue;
    EXPECT_GT(hides.at(effect.effect), 1.0) << effect.effect;
    by_size += effect.reason.find("machines have") != std::string::npos ? 1 : 0;
  }
  RecordProperty("by_size", by_size);
}

}  // namespace
}  // namespace sinew::trace
