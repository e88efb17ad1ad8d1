// The bank's own arithmetic, and a small part of the bank.
#include "tests/bank/bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "tests/bank/figures.h"

namespace sinew::bank {
namespace {

using surrogate::ExcitationKind;

TEST(ClopperPearson, HoldsTheTabledIntervals) {
  // R: binom.test(k, n)$conf.int
  const auto near = [](std::pair<double, double> interval, double low, double high) {
    EXPECT_NEAR(interval.first, low, 5e-5);
    EXPECT_NEAR(interval.second, high, 5e-5);
  };
  near(ClopperPearson(0, 10), 0.0, 0.30850);
  near(ClopperPearson(10, 10), 0.69150, 1.0);
  near(ClopperPearson(5, 10), 0.18709, 0.81291);
  near(ClopperPearson(3, 500), 0.00124, 0.01744);
  near(ClopperPearson(0, 0), 0.0, 1.0);
  EXPECT_THROW(ClopperPearson(3, 2), std::invalid_argument);
  EXPECT_THROW(ClopperPearson(-1, 2), std::invalid_argument);
}

TEST(Scene, TheSameSeedGivesTheSameRecordingsAndAnotherSpecimenWithAnother) {
  const Recorded a = Record({.seed = 3, .trains = 1, .seconds = 4.0});
  const Recorded b = Record({.seed = 3, .trains = 1, .seconds = 4.0});
  const Recorded c = Record({.seed = 4, .trains = 1, .seconds = 4.0});
  for (const auto& [signal, values] : a.train.front().signals) {
    EXPECT_EQ(values, b.train.front().At(signal)) << identify::SignalName(signal);
  }
  EXPECT_NE(a.specimen.Parameter("gravity", "gravity_torque"),
            c.specimen.Parameter("gravity", "gravity_torque"));
}

TEST(Scene, ALaboratoryStatesEveryValueFiveToFifteenPercentOff) {
  const Recorded recorded = Record({.seed = 5, .trains = 1, .seconds = 2.0});
  int stated = 0;
  for (std::size_t t = 0; t < recorded.declared.terms.size(); ++t) {
    const actuator::ParameterValue& said = recorded.declared.terms[t].linear.front();
    const actuator::ParameterValue& is = recorded.specimen.terms[t].linear.front();
    if (said.fixed || is.value == 0.0) {  // exact, or an offset of which nothing is known
      EXPECT_EQ(said.value, is.value);
      continue;
    }
    ++stated;
    const double off = std::abs(said.value / is.value - 1.0);
    EXPECT_GE(off, 0.05);
    EXPECT_LE(off, 0.15);
    EXPECT_EQ(said.tolerance, 0.15);
  }
  EXPECT_EQ(stated, 9);  // eight of the torque balance, and the gas volume
}

TEST(Scene, ColouredNoiseIsAddedToTheCurrentAlone) {
  const Recorded plain = Record({.seed = 6, .trains = 1, .seconds = 20.0});
  const Recorded noisy =
      Record({.seed = 6, .trains = 1, .seconds = 20.0, .coloured_noise_A = 0.05});
  const identify::Run& a = plain.train.front();
  const identify::Run& b = noisy.train.front();
  EXPECT_EQ(a.At(identify::Signal::kPosition), b.At(identify::Signal::kPosition));
  const Eigen::VectorXd noise_A =
      b.At(identify::Signal::kMotorCurrent) - a.At(identify::Signal::kMotorCurrent);
  const Eigen::Index n = noise_A.size();
  const double power = noise_A.squaredNorm() / static_cast<double>(n);
  EXPECT_NEAR(std::sqrt(power), 0.05, 0.012);
  const double neighbours = noise_A.head(n - 1).dot(noise_A.tail(n - 1)) / noise_A.squaredNorm();
  EXPECT_NEAR(neighbours, std::exp(-1.0 / 8.0), 0.04);  // 80 Hz, memory of 0.1 s
}

TEST(Plan, HasEveryEffectInBothStrengthsAndExcitations) {
  const std::vector<Case> cases = MakeCases({.seeds = 2, .without = 8, .pair_seeds = 1});
  std::set<std::string> effects;
  int without = 0, pairs = 0, outside = 0, coloured = 0;
  for (const Case& what : cases) {
    if (what.kind == Kind::kEffect) effects.insert(what.effects.front());
    without += what.kind == Kind::kNone ? 1 : 0;
    coloured += what.coloured ? 1 : 0;
    pairs += what.kind == Kind::kPair ? 1 : 0;
    outside += what.kind == Kind::kOutside ? 1 : 0;
    for (const std::string& name : what.effects) {
      EXPECT_GT(FindSize(name, what.excitation).strong, 0.0) << name;
    }
  }
  EXPECT_EQ(effects.size(), CatalogueNames().size());
  EXPECT_EQ(without, 8);
  EXPECT_EQ(coloured, 4);
  EXPECT_EQ(pairs, 20);
  EXPECT_EQ(outside, 10);
  EXPECT_THROW(MakeCases({.effects = {"nothing"}}), std::invalid_argument);
}

Outcome Said(const std::string& truth, const std::string& verdict, std::vector<Found> found) {
  Outcome out;
  out.what = {.kind = Kind::kEffect, .effects = {truth}};
  out.verdict = verdict;
  out.found = std::move(found);
  out.sealed_before = 2.0;
  out.sealed_after = 1.1;
  out.sealed_oracle = 1.0;
  out.oracle_significant = true;
  out.value = 1.1;
  out.truth = 1.0;
  out.half_width = 0.2;
  return out;
}

TEST(Figures, CountRightWrongAndSilent) {
  const std::vector<Outcome> outcomes = {
      Said("quadratic_viscous", "effect", {{"quadratic_viscous", {}, false}}),
      Said("quadratic_viscous", "effect", {{"stribeck", {"quadratic_viscous"}, false}}),
      Said("quadratic_viscous", "effect", {{"stribeck", {}, false}}),
      Said("quadratic_viscous", "none", {}),
  };
  EXPECT_TRUE(NamedFirst(outcomes[0]));
  EXPECT_FALSE(NamedFirst(outcomes[1]));
  EXPECT_TRUE(NamedItsClass(outcomes[1]));
  EXPECT_FALSE(NamedItsClass(outcomes[2]));
  const Figures figures = CountFigures(outcomes);
  const auto share = [&](const std::string& name) {
    for (const Share& one : figures.shares) {
      if (one.name == name) return one;
    }
    return Share{};
  };
  EXPECT_EQ(share("right effect first, strong").hits, 1);
  EXPECT_EQ(share("right effect first, strong").trials, 4);
  EXPECT_EQ(share("right class").hits, 2);
  EXPECT_EQ(share("confident wrong name").hits, 1);
  EXPECT_TRUE(figures.hidden_cells.empty());
  EXPECT_NEAR(figures.values[0].value, 1.1, 1e-12);
}

TEST(Figures, ACellWhoseTruthIsNotSignificantIsHidden) {
  std::vector<Outcome> outcomes;
  for (int i = 0; i < 3; ++i) {
    outcomes.push_back(Said("quadratic_viscous", "none", {}));
    outcomes.back().oracle_significant = i == 0;
    if (i < 2) outcomes.back().not_excited = {"quadratic_viscous"};
  }
  const Figures figures = CountFigures(outcomes);
  ASSERT_EQ(figures.hidden_cells, (std::vector<std::string>{"quadratic_viscous/strong/designed"}));
  for (const Share& share : figures.shares) {
    if (share.name == "hidden by the excitation: says so") {
      EXPECT_EQ(share.hits, 2);
      EXPECT_EQ(share.trials, 3);
    }
    if (share.name == "right effect first, strong") {
      EXPECT_EQ(share.trials, 0);
    }
  }
}

TEST(Figures, OutcomesGoToJsonAndBack) {
  Outcome one = Said("quadratic_viscous", "effect", {{"stribeck", {"a", "b"}, true}});
  one.what.coloured = true;
  one.what.seed = 77;
  one.truth = std::nan("");
  const Outcome two = FromJson(ToJson(one));
  EXPECT_EQ(ToJson(two), ToJson(one));
  EXPECT_TRUE(std::isnan(two.truth));
  EXPECT_EQ(two.found.front().rivals.size(), 2u);
  EXPECT_THROW(FromJson("{}"), std::invalid_argument);
  EXPECT_THROW(FromJson("no"), std::invalid_argument);
}

// A small part of the bank; the whole of it is bench/bank.
TEST(Bank, AHandfulOfStrongEffectsIsNamed) {
  for (const std::string name :
       {"quadratic_viscous", "direction_dependent_viscous", "load_dependent_friction"}) {
    const Outcome outcome = RunCase({.effects = {name}, .seed = 31}, false);
    EXPECT_TRUE(NamedItsClass(outcome)) << ToJson(outcome);
    EXPECT_LT(outcome.sealed_after, 0.99 * outcome.sealed_before) << name;
    EXPECT_LT(outcome.sealed_after, 1.3 * outcome.sealed_oracle) << name;
  }
}

TEST(Bank, RecordingsWithoutAnEffectRaiseNoAlarm) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Outcome outcome =
        RunCase({.kind = Kind::kNone, .seed = 40000 + seed, .coloured = seed % 2 == 0}, false);
    if (outcome.verdict != "none") {
      ++alarms;
      std::printf("%s\n", ToJson(outcome).c_str());
    }
  }
  EXPECT_EQ(alarms, 0);
}

TEST(Bank, TheSameCaseIsJudgedTheSameOnAnyThread) {
  const std::vector<Case> cases = {{.kind = Kind::kNone, .seed = 50001},
                                   {.kind = Kind::kNone, .seed = 50002}};
  const std::vector<Outcome> one = RunCases(cases, 1, false);
  const std::vector<Outcome> two = RunCases(cases, 2, false);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Outcome a = one[i], b = two[i];
    a.seconds = b.seconds = 0.0;
    EXPECT_EQ(ToJson(a), ToJson(b));
  }
}

TEST(Bank, EncodersThatComeApartTellNoTorques) {
  const Outcome outcome =
      RunCase({.kind = Kind::kOutside, .effects = {"slipping_magnet"}, .seed = 31}, false);
  EXPECT_EQ(outcome.verdict, "unexplained") << ToJson(outcome);
  EXPECT_EQ(outcome.variable, "time_s");
  EXPECT_TRUE(outcome.found.empty());
}

TEST(Bank, ALeakAndATiltedPayloadAreNamed) {
  for (const std::string name : {"leak", "gravity_phase"}) {
    const Outcome outcome = RunCase({.effects = {name}, .seed = 31}, false);
    EXPECT_TRUE(NamedFirst(outcome)) << ToJson(outcome);
    EXPECT_TRUE(outcome.oracle_significant) << name;
    EXPECT_LT(outcome.sealed_after, 1.2 * outcome.sealed_oracle) << name;
  }
}

}  // namespace
}  // namespace sinew::bank
