// Oracles: errors of known size, the ratio of a payload's run to one without, the PID alone.
#include "reproduction/control_test/trial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>

#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "reproduction/control_test/inverse.h"
#include "reproduction/control_test/section.h"
#include "sim/surrogate/file/surrogate_file.h"

namespace sinew::control_test {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;

// Off its reference by 10 mrad until the last two cycles, by 1 mrad there; the lead-in is far off.
types::Run Synthetic(const Trial& trial) {
  const auto count = static_cast<Eigen::Index>(trial.duration_s() / kPeriod_s);
  types::Run run;
  run.name = "synthetic";
  run.time_s = Eigen::VectorXd::LinSpaced(count, 7.0, 7.0 + (count - 1) * kPeriod_s);
  Eigen::VectorXd reference(count), position(count), current(count), speed(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double t = i * kPeriod_s;
    const double late_s = trial.end_s() - kLateCycles / kFrequency_Hz;
    reference[i] = 0.5 * std::sin(2.0 * std::numbers::pi * kFrequency_Hz * t);
    position[i] = reference[i] - (t < kStart_s ? 1.0 : t < late_s ? 0.01 : 0.001);
    current[i] = t < kStart_s + 0.5 / kFrequency_Hz ? 25.0 : 2.0;
    speed[i] = 10.0;
  }
  run.signals[types::Signal::kReferencePosition] = reference;
  run.signals[types::Signal::kPosition] = position;
  run.signals[types::Signal::kMotorCurrent] = current;
  run.signals[types::Signal::kMotorVelocity] = speed;
  return run;
}

TEST(ControlTrial, ScoresTheCyclesAfterTheLeadIn) {
  const Trial trial{Arm::kPid, 4.0, Load::kNone, 4, 1};
  const TrialScore score = ScoreTrial(trial, Synthetic(trial), {0.0159, 25.0});
  // A sample at each border may fall to either side: 2 of 2400.
  constexpr double kBorder = 2e-3;
  EXPECT_NEAR(score.whole.mean_square_error_rad2, 0.5 * (1e-4 + 1e-6), kBorder * 1e-4);
  EXPECT_NEAR(score.late_mse_rad2, 1e-6, kBorder * 1e-4);
  EXPECT_NEAR(score.from_rest_mse_rad2, (1.0 * 2 + 1e-4 * 2 + 1e-6 * 2) / 6.0, kBorder);
  EXPECT_NEAR(score.saturated_share, 0.125, kBorder);
  EXPECT_NEAR(score.positive_work_J, 0.0159 * 10.0 * (25.0 * 1.25 + 2.0 * 8.75), 0.01);
}

TEST(ControlTrial, ARunThatEndsEarlyIsRefused) {
  Trial trial{Arm::kPid, 4.0, Load::kNone, 4, 1};
  const types::Run run = Synthetic(trial);
  trial.cycles = 8;
  EXPECT_THROW(ScoreTrial(trial, run, {0.0159, 25.0}), std::invalid_argument);
}

TEST(ControlTrial, EveryTrialHasANameOfItsOwn) {
  std::vector<Trial> trials = BenchmarkTrials({1, 2, 3});
  const std::vector<Trial> grid =
      GridTrials({2.0, 4.0, 6.0}, {Load::kNone, Load::kExternal, Load::kChanging},
                 {Arm::kPid, Arm::kNetwork, Arm::kAdapted, Arm::kInverse}, 1);
  trials.insert(trials.end(), grid.begin(), grid.end());
  std::set<std::string> names;
  for (const Trial& trial : trials) names.insert(trial.name());
  EXPECT_EQ(names.size(), 12u + 36u);
}

TEST(ControlSection, MarksWhatIsReachedAndWhatIsMissed) {
  std::vector<Outcome> outcomes;
  for (const auto& [arm, mse_rad2] : {std::pair{Arm::kPid, 1e-3},
                                      {Arm::kLinear, 5e-4},
                                      {Arm::kNetwork, 1e-4},
                                      {Arm::kInverse, 1e-5}}) {
    Outcome outcome;
    outcome.trial.arm = arm;
    outcome.score.whole.mean_square_error_rad2 = mse_rad2;
    outcomes.push_back(outcome);
  }
  const report::Section section = MakeSection(outcomes, {});
  report::CheckSection(section);
  ASSERT_EQ(section.comparisons.size(), 7u);
  EXPECT_EQ(section.comparisons[5].met, true) << "0.1 of the PID";
  EXPECT_EQ(section.comparisons[6].met, false) << "10 x the bound";
  outcomes.pop_back();
  EXPECT_THROW(MakeSection(outcomes, {}), std::invalid_argument);
}

InverseConfig Benchmark() {
  const std::string rig = std::string(SINEW_SOURCE_DIR) + "/robots/rig/";
  InverseConfig config;
  config.loop.control = control::LoadControl(rig + "control_pid.yaml").joints;
  config.loop.reference = reference::LoadReference(rig + "reference_benchmark.yaml").config;
  config.loop.pneumatics = pneumatics::LoadPneumatics(rig + "pneumatics.yaml").joints;
  config.loop.duration_s = 13.0;
  config.loop.score_from_s = kSoftStart_s;
  config.loop.score_to_s = 12.5;
  config.rig = surrogate::LoadRig(rig + "surrogate.yaml");
  return config;
}

TEST(TrueInverse, FollowsTheReferenceAThousandTimesBetterThanThePid) {
  InverseConfig config = Benchmark();
  config.iterations = 5;
  const Inverse inverse = InvertSurrogate(config);
  ASSERT_EQ(inverse.mse_by_round_rad2.size(), 6u);
  EXPECT_LT(inverse.mse_rad2, 1e-3 * inverse.mse_by_round_rad2.front());
  EXPECT_NEAR(inverse.torque.period_s, kPeriod_s, 1e-12);
}

TEST(TrueInverse, WithoutAModelOrRoundsItIsRefused) {
  InverseConfig config = Benchmark();
  config.iterations = 0;
  EXPECT_THROW(InvertSurrogate(config), std::invalid_argument);
  config = Benchmark();
  config.loop.control[0].model.reset();
  EXPECT_THROW(InvertSurrogate(config), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::control_test
