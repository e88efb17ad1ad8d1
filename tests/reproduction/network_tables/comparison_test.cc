#include "reproduction/network_tables/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "reproduction/network_tables/comparison_text.h"

namespace sinew::reproduction {
namespace {

using ::testing::HasSubstr;

TEST(Comparison, PairedIntervalIsStudentsOverThePairs) {
  // Differences 1, 2, 3: mean 2, standard error 1 / sqrt 3, t(2, 0.975) = 4.30265.
  const PairedOrder order = ComparePaired({1.0, 5.0, 2.0}, {2.0, 7.0, 5.0});
  EXPECT_EQ(order.pairs, 3);
  EXPECT_DOUBLE_EQ(order.mean, 2.0);
  EXPECT_NEAR(order.low, 2.0 - 4.30265 / std::sqrt(3.0), 1e-4);
  EXPECT_NEAR(order.high, 2.0 + 4.30265 / std::sqrt(3.0), 1e-4);
  EXPECT_EQ(order.verdict, "not distinguished");
  EXPECT_EQ(ComparePaired({1.0, 2.0, 3.0}, {2.0, 3.1, 4.0}).verdict, "as published");
  EXPECT_EQ(ComparePaired({2.0, 3.1, 4.0}, {1.0, 2.0, 3.0}).verdict, "reversed");
  EXPECT_THROW((void)ComparePaired({1.0}, {2.0}), std::invalid_argument);
  EXPECT_THROW((void)ComparePaired({1.0, 2.0}, {2.0}), std::invalid_argument);
}

ComparisonOptions Small() {
  ComparisonOptions options;
  options.task = networks::Task::kPea;
  options.seeds = 2;
  options.trials = 1;
  options.epochs = 1;
  options.fair_epochs = 2;
  options.patience = 2;
  options.duration_s = 12.0;
  return options;
}

TEST(Comparison, HasEveryModelOfTheTableWithItsParametersAndTheGreyBox) {
  std::size_t done = 0, total = 0;
  const ComparisonResult result = Compare(Small(), [&](std::size_t d, std::size_t t) {
    done = d;
    total = t;
  });
  EXPECT_EQ(done, total);
  int published = 0;
  for (const ComparedModel& model : result.models) {
    if (model.extra) continue;
    ++published;
    EXPECT_EQ(model.parameters, model.plan.published_parameters) << model.plan.name;
    ASSERT_TRUE(model.as_published.has_value());
    EXPECT_EQ(model.as_published->test_mse.size(), 2U);
    for (const double mse : model.fair.test_mse) EXPECT_GT(mse, result.noise_floor);
    EXPECT_GT(model.step_us, 0.0);
    // The parts of the error are all of it.
    EXPECT_NEAR(model.quiet_mse + model.busy_mse, model.fair.Mean(model.fair.test_mse), 1e-9)
        << model.plan.name;
  }
  EXPECT_EQ(published, 7);
  EXPECT_EQ(result.order_fair.size(), 6U);
  EXPECT_EQ(result.models.back().plan.name, "grey box");
  EXPECT_GT(result.constant_torque_noise_share, 0.8);

  const std::string text = FormatComparison(result);
  EXPECT_THAT(text, HasSubstr("Wiener ESN"));
  EXPECT_THAT(text, HasSubstr("noise floor"));
  EXPECT_THAT(text, HasSubstr("chamber_pressure_bar"));
  EXPECT_THAT(text, HasSubstr("share of its variance"));
  const report::Section section = ComparisonSection(result);
  EXPECT_NO_THROW(report::CheckSection(section));
  EXPECT_EQ(ComparisonJson(result)["models"].size(), result.models.size());
}

TEST(Comparison, TheSameSeedGivesTheSameErrors) {
  const ComparisonResult a = Compare(Small());
  ComparisonOptions one_thread = Small();
  one_thread.threads = 1;
  const ComparisonResult b = Compare(one_thread);
  for (std::size_t m = 0; m < a.models.size(); ++m) {
    EXPECT_EQ(a.models[m].fair.test_mse, b.models[m].fair.test_mse) << a.models[m].plan.name;
  }
}

TEST(Comparison, ImpossibleOptionsAreRefused) {
  ComparisonOptions options = Small();
  options.seeds = 1;
  EXPECT_THROW((void)Compare(options), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::reproduction
