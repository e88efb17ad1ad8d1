// Effects are planted in the plant that moved the pendulum, never as columns.
#include "components/model/shooting/close_by_simulation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/plant/joint_body.h"
#include "tests/components/model/shooting/swing.h"

namespace sinew::shooting {
namespace {

using trace::Verdict;

trace::TraceResult Closed(const std::vector<types::Run>& train, const types::Run& held_out) {
  return CloseBySimulation(train, {held_out}, Declared(), 0.25, {}, plant::JointAlone()).trace;
}

const actuator::ParameterValue& Value(const actuator::JointModel& model,
                                      const std::string& effect) {
  return model.terms[static_cast<std::size_t>(model.Find(effect))].linear[0];
}

TEST(CloseBySimulation, ACleanSwingHasNoEffectAndItsParametersAreWithinTheirIntervals) {
  const trace::TraceResult result =
      Closed({Swing(Pendulum(), {.duration_s = 8.0})},
             Swing(Pendulum(), {.duration_s = 5.0, .release_rad = -1.0, .seed = 2}));
  EXPECT_EQ(result.verdict, Verdict::kNone);
  EXPECT_THAT(result.effects, testing::IsEmpty());
  for (const actuator::Term& term : Pendulum().terms) {
    if (term.linear[0].fixed) continue;
    const actuator::ParameterValue& fitted = Value(result.corrected, term.effect->info().name);
    EXPECT_NEAR(fitted.value, term.linear[0].value, *fitted.half_width_95)
        << term.effect->info().name;
  }
  EXPECT_LT(result.before_held_out.rms, 0.05 * result.nominal_held_out.rms);
  EXPECT_THAT(result.not_excited, testing::Not(testing::IsEmpty()));
}

TEST(CloseBySimulation, FrictionThatGrowsWithTheSquareOfTheSpeedIsNamed) {
  actuator::JointModel truth = Pendulum();
  constexpr double kQuadratic_Nm_s2_rad2 = 0.02;
  truth.terms.push_back(identify::TermOf("quadratic_viscous", {kQuadratic_Nm_s2_rad2}, {}));
  const trace::TraceResult result =
      Closed({Swing(truth, {.duration_s = 8.0})},
             Swing(truth, {.duration_s = 5.0, .release_rad = -1.0, .seed = 2}));
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  ASSERT_EQ(result.effects.size(), 1u);
  const trace::FoundEffect& found = result.effects.front();
  EXPECT_EQ(found.name, "quadratic_viscous");
  EXPECT_EQ(found.confirmation.verdict, trace::ConfirmationVerdict::kConfirmed);
  const actuator::ParameterValue& size = found.fitted.front().linear.front();
  EXPECT_NEAR(size.value, kQuadratic_Nm_s2_rad2, *size.half_width_95);
  EXPECT_LT(found.held_out_after, 0.2 * found.held_out_before);
}

// It sticks where it swings little; a balance of torques has no row there.
TEST(CloseBySimulation, ABreakawayAboveTheMovingFrictionIsNamed) {
  actuator::JointModel truth = Pendulum();
  truth.terms.push_back(identify::TermOf("stribeck", {0.05}, {}));
  truth.terms.back().nonlinear[0].value = 0.1;
  const auto slow = [&](std::uint64_t seed) {
    return Swing(
        truth,
        {.duration_s = 20.0, .release_rad = 0.1, .torque_Nm = 0.25, .slow_Hz = 0.1, .seed = seed});
  };
  const trace::TraceResult result = Closed({slow(1), slow(2)}, slow(3));
  ASSERT_FALSE(result.effects.empty());
  EXPECT_EQ(result.effects.front().name, "stribeck");
  EXPECT_LT(result.after_held_out.rms, 0.5 * result.before_held_out.rms);
}

TEST(CloseBySimulation, TwoSecondsAreTooLittle) {
  const trace::TraceResult result = Closed({Swing(Pendulum(), {.duration_s = 2.0})},
                                           Swing(Pendulum(), {.duration_s = 5.0, .seed = 2}));
  EXPECT_EQ(result.verdict, Verdict::kTooLittleData);
  ASSERT_TRUE(result.too_little.has_value());
  EXPECT_EQ(result.too_little->rule, trace::rules::kBlocks.id);
}

}  // namespace
}  // namespace sinew::shooting
