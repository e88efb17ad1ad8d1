// The experiments against the truth of the surrogate: the project's targets, on specimens whose
// parameters are not the published ones. How often intervals hold the truth is counted by
// `sinew experiment --seeds`; here a few specimens keep it from breaking.
#include "reproduction/laboratory/laboratory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/model/experiment/breakaway.h"
#include "reproduction/laboratory/coverage.h"

namespace sinew::laboratory {
namespace {

constexpr double kSpread = 0.1;

experiment::Result Measure(const char* name, std::uint64_t seed, int trials = 0) {
  const surrogate::RigParameters specimen = MakeSpecimen({}, kSpread, seed);
  return RunOnSurrogate(name, specimen,
                        {.size = Size::kCoverage, .trials = trials, .constants = {}, .seed = seed})
      .result;
}

void ExpectTargetsMet(const experiment::Result& result) {
  int targets = 0;
  for (const experiment::Quantity& q : result.quantities) {
    if (!q.has_interval || !q.Met()) continue;
    ++targets;
    EXPECT_TRUE(*q.Met()) << q.id << ": " << q.estimate.value << ", true " << *q.truth;
    // Twice the interval: a few seeds in a hundred may miss it once.
    EXPECT_NEAR(q.estimate.value, *q.truth, 2.0 * q.estimate.half_width_95 + 1e-12) << q.id;
  }
  EXPECT_GT(targets, 0);
}

TEST(Laboratory, BacklashIsRecovered) { ExpectTargetsMet(Measure("backlash", 11, 20)); }
TEST(Laboratory, BreakawayGivesFrictionAndGravity) {
  ExpectTargetsMet(Measure("breakaway", 12, 3));
}
TEST(Laboratory, PushesGiveSlopeAndMovingFriction) {
  ExpectTargetsMet(Measure("moving-friction", 13));
}
TEST(Laboratory, MotorAloneGivesInertiaAndDamping) { ExpectTargetsMet(Measure("motor", 14)); }

TEST(Laboratory, StiffnessIsASecantThatFrictionEndsAndAGasThatTheReservoirSoftens) {
  const experiment::Result result = Measure("stiffness", 15);
  for (const char* id : {"secant_6bar_Nm_rad", "return_limit_bar"}) {
    const experiment::Quantity* q = result.Find(id);
    ASSERT_NE(q, nullptr);
    EXPECT_NEAR(q->estimate.value, *q->truth, 0.01 * *q->truth) << id;
  }
  const experiment::Quantity* shut = result.Find("gas_shut_Nm_rad");
  const experiment::Quantity* open = result.Find("gas_open_Nm_rad");
  ASSERT_TRUE(shut != nullptr && open != nullptr);
  EXPECT_NEAR(shut->estimate.value, *shut->truth, 2.0 * shut->estimate.half_width_95);
  EXPECT_LT(open->estimate.value, 0.4 * shut->estimate.value);
  EXPECT_FALSE(result.remarks.empty());  // where the link last came back
}

TEST(Laboratory, SeaDataHasThePublishedShape) {
  const experiment::Result result = RunOnSurrogate("sea-data", {}, {.seed = 3}).result;
  EXPECT_NEAR(result.Find("pushes_Hz")->estimate.value, 2.0, 0.1);
  EXPECT_NEAR(result.Find("recorded_s")->estimate.value, 100.0, 0.5);
  EXPECT_NEAR(result.Find("set_end_bar")->estimate.value, 2.2, 0.2);
  EXPECT_EQ(result.figures.size(), 5u);  // three of Fig 5.5, 5.7, 5.8
}

TEST(Laboratory, PeaDataGoesFromUprightToHangingAndBack) {
  const experiment::Result result = RunOnSurrogate("pea-data", {}, {.trials = 6, .seed = 3}).result;
  EXPECT_EQ(result.Find("cycles")->estimate.value, 6.0);
  EXPECT_LT(result.Find("lowest_deg")->estimate.value, -75.0);
  EXPECT_NEAR(result.Find("highest_deg")->estimate.value, 90.0, 8.0);
}

TEST(Laboratory, OneSeedGivesOneResult) {
  const experiment::Result one = Measure("backlash", 21, 6), two = Measure("backlash", 21, 6);
  const experiment::Result other = Measure("backlash", 22, 6);
  EXPECT_EQ(one.quantities[0].estimate.value, two.quantities[0].estimate.value);
  EXPECT_NE(one.quantities[0].estimate.value, other.quantities[0].estimate.value);
}

TEST(Laboratory, SpecimensDifferInWhatTheExperimentsLookFor) {
  const surrogate::RigParameters one = MakeSpecimen({}, 0.1, 1), two = MakeSpecimen({}, 0.1, 2);
  EXPECT_NE(one.gear.play_rad, two.gear.play_rad);
  EXPECT_NE(one.rotor.inertia_kg_m2, two.rotor.inertia_kg_m2);
  EXPECT_NE(one.link.friction.kinetic_Nm, two.link.friction.kinetic_Nm);
  EXPECT_NEAR(one.gear.play_rad, surrogate::GearParameters{}.play_rad,
              0.1 * one.gear.play_rad + 0.01);
  EXPECT_EQ(MakeSpecimen({}, 0.0, 5).gear.play_rad, surrogate::GearParameters{}.play_rad);
}

TEST(Laboratory, AnUnknownExperimentIsRefused) {
  EXPECT_THROW((void)RunOnSurrogate("wobble", {}, {}), std::invalid_argument);
}

TEST(CoverageCount, CountsIntervalsTargetsAndBias) {
  CoverageCount count;
  experiment::Result result;
  result.quantities = {{.id = "a", .estimate = {1.0, 0.2, 5}, .truth = 1.1, .target_share = 0.05},
                       {.id = "b", .estimate = {1.0, 0.2, 5}}};  // no truth: not counted
  count.Add(result);
  result.quantities[0].truth = 2.0;
  count.Add(result);
  ASSERT_EQ(count.by_id().size(), 1u);
  const Coverage& a = count.by_id().at("a");
  EXPECT_EQ(a.seeds, 2);
  EXPECT_EQ(a.covered, 1);
  EXPECT_EQ(a.met, 0);
  EXPECT_NEAR(a.largest_error, 0.5, 1e-12);
  EXPECT_NEAR(a.mean_error, 0.5 * (-0.1 / 1.1 - 0.5), 1e-12);
}

}  // namespace
}  // namespace sinew::laboratory
