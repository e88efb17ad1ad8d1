#include "reproduction/networks/dataset/dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "reproduction/networks/grey_box.h"

namespace sinew::networks {
namespace {

using types::Signal;

// 100 s at 80 Hz: a hand that pushes at 2 Hz, and a link that comes back until 60 s.
types::Run PushedLink() {
  types::Run run;
  run.name = "pushed";
  const Eigen::Index count = 8000;
  run.time_s = Eigen::VectorXd::LinSpaced(count, 0.0, 99.9875);
  const auto column = [&](Signal signal, auto value) {
    Eigen::VectorXd x(count);
    for (Eigen::Index t = 0; t < count; ++t) x(t) = value(run.time_s(t));
    run.signals[signal] = x;
  };
  const auto push = [](double t) {
    return t < 5.0 ? 0.0 : std::sin(12.566 * t) > 0.0 ? 10.0 : 0.0;
  };
  column(Signal::kMotorPosition, [](double) { return 0.0; });
  column(Signal::kMotorVelocity, [](double) { return 0.0; });
  column(Signal::kPosition, [&](double t) { return t < 60.0 && push(t) == 0.0 ? 0.023 : -0.023; });
  column(Signal::kVelocity, [](double t) { return std::sin(t); });
  column(Signal::kChamberPressure, [](double t) { return 6.0 - 0.05 * t; });
  column(Signal::kLoadForce, push);
  return run;
}

TEST(Table, SeaRunsFromTheFirstPushUntilTheLinkNoLongerComesBack) {
  const std::vector<esn::Sequence> q = MakeTable({PushedLink()}, {.task = Task::kSea});
  ASSERT_EQ(q.size(), 1U);
  EXPECT_NEAR(static_cast<double>(q[0].inputs.rows()) / 80.0, 55.0, 0.6);
  EXPECT_NEAR(q[0].targets.maxCoeff(), 3.0, 1e-9);  // 10 N at 0.3 m
  EXPECT_NEAR(q[0].inputs.col(0).maxCoeff(), 0.023, 1e-9);
  EXPECT_NEAR(q[0].inputs(0, 2), 5.75, 0.01);
  const std::vector<esn::Sequence> whole =
      MakeTable({PushedLink()}, {.task = Task::kSea, .whole_sea_set = true});
  EXPECT_EQ(whole[0].inputs.rows(), 8000);
}

TEST(Table, TenBlocksEachSplitSeventyToThirty) {
  const std::vector<esn::Sequence> q =
      MakeTable({PushedLink()}, {.task = Task::kSea, .whole_sea_set = true});
  int train = 0, changes = 0;
  for (std::size_t t = 0; t < q[0].use.size(); ++t) {
    if (q[0].use[t] == esn::Use::kTrain) ++train;
    if (t > 0 && q[0].use[t] != q[0].use[t - 1]) ++changes;
  }
  EXPECT_EQ(train, 5600);
  EXPECT_EQ(changes, 19);
}

TEST(Table, TheCurrentIsNoInputOfTheTaskWhoseTargetItContains) {
  types::Run run = PushedLink();
  const Eigen::Index count = run.size();
  Eigen::VectorXd current(count), moving(count);
  for (Eigen::Index t = 0; t < count; ++t) {
    current(t) = std::sin(0.37 * static_cast<double>(t * t % 977));
    moving(t) = std::sin(0.02 * static_cast<double>(t));
  }
  run.signals[Signal::kMotorCurrent] = current;
  run.signals[Signal::kPosition] = moving;
  run.signals[Signal::kMotorPosition] = 100.0 * moving;
  const std::vector<esn::Sequence> q = MakeTable({run}, {.task = Task::kPea});
  ASSERT_EQ(q[0].inputs.cols(), 6);
  EXPECT_NEAR(q[0].targets(10, 0), current(10) * 0.0159155, 1e-6);
  const Eigen::VectorXd target = q[0].targets.col(0).array() - q[0].targets.col(0).mean();
  for (int m = 0; m < 6; ++m) {
    const Eigen::VectorXd input = q[0].inputs.col(m).array() - q[0].inputs.col(m).mean();
    if (input.norm() == 0.0) continue;
    EXPECT_LT(std::abs(input.dot(target)) / (input.norm() * target.norm()), 0.1) << m;
  }
}

TEST(Table, ASignalThatIsMissingIsNamed) {
  types::Run run = PushedLink();
  run.signals.erase(Signal::kChamberPressure);
  try {
    (void)MakeTable({run}, {.task = Task::kSea});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("chamber_pressure"));
  }
  EXPECT_THROW((void)MakeTable({}, {}), std::invalid_argument);
  EXPECT_THROW((void)MakeTable({PushedLink()}, {.period_s = 0.0}), std::invalid_argument);
}

// Data made by the declared formula: the coefficients come back.
TEST(GreyBox, FindsTheCoefficientsOfItsOwnFormula) {
  esn::Sequence q;
  q.inputs.resize(1000, 6);
  q.targets.resize(1000, 1);
  for (int t = 0; t < 1000; ++t) {
    for (int m = 0; m < 6; ++m) q.inputs(t, m) = std::sin(0.013 * (m + 1.3) * t + m);
    q.targets(t, 0) = 1e-5 * q.inputs(t, 4) + 2e-3 * q.inputs(t, 1) +
                      0.004 * std::tanh(q.inputs(t, 1) / 0.03) + 0.006 * std::cos(q.inputs(t, 0)) -
                      0.0036 * q.inputs(t, 2) + 0.003 * q.inputs(t, 3) + 0.001;
    q.use.push_back(esn::Use::kTrain);
  }
  const Samples samples = MakeSamples({q});
  Eigen::MatrixXd predicted;
  const GreyBox model = FitGreyBox(Task::kPea, samples, &predicted);
  const double expected[] = {1e-5, 2e-3, 0.004, 0.006, -0.0036, 0.003, 0.001};
  ASSERT_EQ(model.parameter_count(), 7);
  for (int k = 0; k < 7; ++k) EXPECT_NEAR(model.coefficients(k), expected[k], 1e-9);
  EXPECT_LT(MeanSquare(samples, predicted, samples.train), 1e-12);
}

}  // namespace
}  // namespace sinew::networks
