// The size reported as detectable is found about as often as its stated power.
#include "components/model/trace/sensitivity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
  const double gain = NeededGain(h, 1e5, kOccam, 3.0, kNever);
  EXPECT_NEAR(gain - kOccam, share * (1e5 + gain), 1e-6 * gain);
  // A short one by the p of the whole search.
  EXPECT_DOUBLE_EQ(NeededGain(h, 100.0, kOccam, 5.0, kNever), GainOfStatistic(5.0, h));
  // Where noise is coloured, less of the misfit is enough.
  EXPECT_DOUBLE_EQ(NeededGain(h, 1e5, kOccam, 3.0, 500.0), 500.0);
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
  for (const CandidateScore& score : result.rounds.front().scores) {
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

TEST(Detectable, WhatStandsOutOfNoiseCouldNotHide) {
  const TraceResult result = TraceDrag(0.5, 8);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  std::set<std::string> hidden;
  for (const NotExcited& effect : result.not_excited) hidden.insert(effect.effect);
  int shown = 0;
  for (const CandidateScore& score : result.rounds.front().scores) {
    // Twenty standard deviations; a search without an effect stays below five.
    if (score.statistic < 20.0) continue;
    ++shown;
    EXPECT_EQ(hidden.count(score.name), 0u) << score.name;
    EXPECT_EQ(std::count(result.assessed.begin(), result.assessed.end(), score.name), 1)
        << score.name;
  }
  EXPECT_GT(shown, 1);  // the drag and what resembles it
  EXPECT_GT(hidden.size(), 0u);
}

}  // namespace
}  // namespace sinew::trace
