#include "components/model/trace/close_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Recipe;
using identify::SyntheticModel;
using identify::SyntheticRun;
using identify::TermOf;

actuator::JointModel Churning() {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.push_back(TermOf("quadratic_viscous", {0.4}, truth.constants));
  return truth;
}

TEST(CloseLoop, RecordingsInEffectOut) {
  const actuator::JointModel truth = Churning();
  const auto run = [&](std::uint64_t seed) {
    return SyntheticRun(truth, {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.1});
  };
  const LoopResult loop = CloseLoop({run(1), run(2)}, {run(3)}, SyntheticModel(), 0.25, {});
  ASSERT_EQ(loop.trace.verdict, Verdict::kEffect);
  EXPECT_EQ(loop.trace.effects.front().name, "quadratic_viscous");
  // What was left to the data is filled in, and the designs are those that the errors are of.
  EXPECT_GT(loop.processing.parallel_cutoff_Hz, 0.0);
  ASSERT_TRUE(loop.held_out.has_value());
  EXPECT_DOUBLE_EQ(identify::ErrorOf(*loop.held_out, loop.trace.corrected, loop.trace.nominal).rms,
                   loop.trace.after_held_out.rms);
}

using Lines = std::vector<std::pair<int, double>>;  // order and size, A
const Lines kLines_A = {{7, 0.8}, {28, 0.5}, {12, 0.1}, {90, 0.06}};

// A map of cogging: one turn of positions that were held, in an order that says nothing. The
// encoder started where the angle is zero_rad.
types::Run Map(int positions, std::uint64_t seed, double zero_rad = 0.0,
               const Lines& lines_A = kLines_A) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise_A(0.0, 0.02);
  std::vector<int> places(static_cast<std::size_t>(positions));
  std::iota(places.begin(), places.end(), 0);
  std::shuffle(places.begin(), places.end(), random);
  types::Run run;
  run.name = "map_" + std::to_string(seed);
  run.held = true;
  run.time_s = Eigen::VectorXd::LinSpaced(positions, 0.0, 3.0 * (positions - 1));
  Eigen::VectorXd angle(positions), current(positions);
  for (int i = 0; i < positions; ++i) {
    angle[i] = 2.0 * M_PI * places[static_cast<std::size_t>(i)] / positions;
    current[i] = 0.1 + noise_A(random);
    for (const auto& [order, size] : lines_A) {
      current[i] += size * std::cos(order * (angle[i] + zero_rad) + 1);
    }
  }
  run.signals[types::Signal::kPosition] = angle;
  run.signals[types::Signal::kMotorPosition] = angle;
  run.signals[types::Signal::kMotorCurrent] = current;
  return run;
}

actuator::JointModel Motor() {
  actuator::JointModel motor;
  motor.name = "motor";
  motor.constants.gear_ratio = 1.0;
  motor.constants.torque_constant_Nm_A = 0.05;
  motor.terms = {TermOf("drive_current", {1.0}, motor.constants),
                 TermOf("offset", {0.005}, motor.constants, 5.0)};
  motor.terms[0].linear[0].fixed = true;
  return motor;
}

TEST(CloseLoop, AllOrdersOfAMapOfHeldPositionsAreOneEffect) {
  const LoopResult loop = CloseLoop({Map(1000, 1)}, {Map(500, 2)}, Motor(), 0.25, {});
  ASSERT_EQ(loop.trace.effects.size(), 1u);
  EXPECT_EQ(loop.trace.effects.front().name, "cogging");
  EXPECT_EQ(loop.trace.effects.front().confirmation.verdict, ConfirmationVerdict::kConfirmed);
  std::vector<double> orders;
  for (const actuator::Term& term : loop.trace.corrected.terms) {
    if (!term.declared) orders.push_back(term.nonlinear[0].value);
  }
  EXPECT_THAT(orders, ::testing::ElementsAre(7, 28, 12, 90));
  // What is left is the noise of the current.
  EXPECT_NEAR(loop.trace.after_held_out.rms, 0.02 * 0.05, 0.1 * 0.02 * 0.05);
  EXPECT_TRUE(loop.trace.events.empty());
  EXPECT_TRUE(loop.trace.zero_turns.empty());
}

TEST(CloseLoop, AnEncoderThatStartedElsewhereTurnsTheMap) {
  const LoopResult loop = CloseLoop({Map(1000, 1)}, {Map(500, 2, 0.7)}, Motor(), 0.25, {});
  ASSERT_EQ(loop.trace.effects.size(), 1u);
  EXPECT_EQ(loop.trace.effects.front().name, "cogging");
  ASSERT_EQ(loop.trace.zero_turns.size(), 1u);
  EXPECT_EQ(loop.trace.zero_turns.front().recording, "map_2");
  EXPECT_NEAR(loop.trace.zero_turns.front().turn_rad, 0.7, 2.0 * M_PI / (16.0 * 90.0));
  EXPECT_LT(loop.trace.after_held_out.rms, 2.0 * 0.02 * 0.05);
}

TEST(CloseLoop, TheMapOfAnotherMotorIsNotTurnedIntoThisOne) {
  const LoopResult loop = CloseLoop(
      {Map(1000, 1)}, {Map(500, 2, 0.7, {{7, 0.2}, {28, 0.1}, {10, 0.6}})}, Motor(), 0.25, {});
  EXPECT_TRUE(loop.trace.effects.empty());
  EXPECT_NE(loop.trace.verdict, Verdict::kEffect);
}

TEST(CloseLoop, AHeldOutRecordingThatWasTrainedOnIsRefused) {
  types::Run run = SyntheticRun(SyntheticModel(), Recipe{.duration_s = 5.0});
  run.content_hash = "abc";
  types::Run copy = run;
  copy.name = "copy";
  EXPECT_THROW(RequireHeldOut({run}, {copy}), std::invalid_argument);
  copy.content_hash = "abd";
  EXPECT_NO_THROW(RequireHeldOut({run}, {copy}));
}

}  // namespace
}  // namespace sinew::trace
