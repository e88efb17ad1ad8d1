#include "reproduction/legs_table/legs_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sinew::reproduction {
namespace {

// A robot whose torques are a linear function of its motion.
LegsData Linear(int joints) {
  constexpr int kSamples = 800;
  esn::Sequence sequence;
  sequence.inputs.resize(kSamples, 3 * joints);
  sequence.targets.resize(kSamples, joints);
  for (int t = 0; t < kSamples; ++t) {
    for (int j = 0; j < joints; ++j) {
      const double phase = 0.02 * t * (1.0 + 0.1 * j);
      const double q = std::sin(phase), v = std::cos(phase), a = -std::sin(phase);
      sequence.inputs.row(t).segment<3>(3 * static_cast<Eigen::Index>(j)) << q, v, a;
      sequence.targets(t, j) = 2.0 * a + 0.5 * v + 0.1 * j * q;
    }
    sequence.use.push_back(t < 640 ? esn::Use::kTrain : esn::Use::kTest);
  }
  return {joints, networks::MakeSamples({sequence}), networks::MakeSamples({sequence}, 0.2, 12)};
}

LegsTableOptions Few(int threads) {
  LegsTableOptions options;
  options.seeds = 2;
  options.trials = 2;
  options.epochs = 3;
  options.patience = 2;
  options.threads = threads;
  return options;
}

TEST(LegsTable, HasThePublishedModelsForBothCountsAndTheSameOnAnyNumberOfThreads) {
  const std::vector<LegsData> data = {Linear(12), Linear(6)};
  std::size_t last = 0, total = 0;
  const std::vector<LegsModel> models =
      FillLegsTable(data, Few(1), [&](std::size_t done, std::size_t of) {
        last = done;
        total = of;
      });
  ASSERT_EQ(models.size(), 8U);
  EXPECT_EQ(last, total);
  EXPECT_EQ(total, 8U * (2 + 4));
  for (const LegsModel& model : models) {
    if (model.joints == 12) {
      EXPECT_EQ(model.parameters, model.plan.published_parameters);
    }
    for (const double mse : model.published.test_mse) EXPECT_GT(mse, 0.0);
    EXPECT_FALSE(model.chosen.empty());
  }
  const std::vector<LegsModel> again = FillLegsTable(data, Few(2));
  for (std::size_t m = 0; m < models.size(); ++m) {
    EXPECT_EQ(models[m].published.test_mse, again[m].published.test_mse) << models[m].plan.name;
    EXPECT_EQ(models[m].fair.test_mse, again[m].fair.test_mse) << models[m].plan.name;
  }
}

TEST(LegsTable, TheSectionComparesTheEsnWithTheFfnn) {
  std::vector<LegsModel> models;
  for (networks::PublishedModel& plan : networks::Table65()) {
    LegsModel model;
    model.joints = 12;
    model.parameters = networks::CountParameters(plan);
    const double mse = plan.name == "ESN" ? 0.04 : 0.05;
    model.plan = std::move(plan);
    model.published = {{mse, mse}, {mse, mse}, {1.0, 1.0}};
    model.fair = {{0.05, 0.05}, {0.05, 0.05}, {1.0, 1.0}};
    models.push_back(std::move(model));
  }
  const report::Section section = LegsSection(models, Few(1), "Data: none.");
  report::CheckSection(section);
  ASSERT_EQ(section.comparisons.size(), 2U);
  EXPECT_EQ(section.comparisons[0].ours, "0.800");
  EXPECT_TRUE(section.comparisons[0].met.value());
  EXPECT_FALSE(section.comparisons[1].met.value());
  models.pop_back();
  EXPECT_THROW(LegsSection(models, Few(1), "Data: none."), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::reproduction
