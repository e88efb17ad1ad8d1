#include "tools/networks/sets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "components/config/config.h"
#include "components/esn/normal.h"
#include "components/networks/grey_box.h"
#include "components/networks/samples.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tools/networks/cylinder.h"
#include "tools/networks/jobs.h"

namespace sinew::tools {
namespace {

using networks::Task;
using ::testing::HasSubstr;

TEST(Sets, TheSameSeedGivesTheSameRecordingAndAnotherSeedAnotherOne) {
  const SetOptions options{.task = Task::kSea, .duration_s = 6.0, .seed = 3};
  SetOptions other = options;
  other.seed = 4;
  const std::string hash = MakeSurrogateRun(options).content_hash;
  EXPECT_EQ(MakeSurrogateRun(options).content_hash, hash);
  EXPECT_NE(MakeSurrogateRun(other).content_hash, hash);
  EXPECT_THROW((void)MakeSurrogateRun({.task = Task::kForce}), std::invalid_argument);
}

TEST(Sets, ThePressureOfSeaFallsAndTheLinkStopsComingBack) {
  const types::Run run = MakeSurrogateRun({.task = Task::kSea, .seed = 1});
  const auto sequences = networks::MakeTable({run}, {.task = Task::kSea});
  const double seconds = static_cast<double>(sequences[0].inputs.rows()) / 80.0;
  EXPECT_GT(seconds, 20.0);
  EXPECT_LT(seconds, run.time_s(run.size() - 1) - 20.0);
  // The chamber stops bringing the link back near 2 bar (Fig 5.9).
  const double last_bar = sequences[0].inputs(sequences[0].inputs.rows() - 1, 2);
  EXPECT_GT(last_bar, 1.0);
  EXPECT_LT(last_bar, 3.5);
}

TEST(Sets, TheTorqueOfPeaVariesFarAboveTheNoiseOfTheCurrent) {
  const auto variance = [](bool constant) {
    const auto sequences = networks::MakeTable(
        {MakeSurrogateRun(
            {.task = Task::kPea, .duration_s = 30.0, .seed = 2, .constant_torque = constant})},
        {.task = Task::kPea});
    const double scale = networks::MakeSamples(sequences).output.scale(0);
    return scale * scale;
  };
  EXPECT_GT(variance(false), 100.0 * NoiseFloor(Task::kPea));
  // With one set point nothing but noise is left.
  EXPECT_LT(variance(true), 1.5 * NoiseFloor(Task::kPea));
}

TEST(Sets, NoiseFromDifferencesIsThatOfTheNoise) {
  esn::NormalGenerator random(5);
  Eigen::VectorXd signal(20000);
  for (Eigen::Index t = 0; t < signal.size(); ++t) {
    signal(t) = 3.0 * std::sin(0.01 * static_cast<double>(t)) + 0.1 * random.Next();
  }
  // The median of 20000 differences, neighbours correlated, is good to some percent.
  EXPECT_NEAR(NoiseFromDifferences(signal), 0.01, 0.0006);
}

TEST(Jobs, EveryOneRunsOnceAndAFailureIsThrown) {
  std::vector<int> count(50, 0);
  std::vector<std::function<void()>> jobs;
  for (int& c : count) jobs.push_back([&c] { ++c; });
  std::size_t last = 0;
  RunJobs(jobs, 2, [&](std::size_t done) { last = done; });
  for (const int c : count) EXPECT_EQ(c, 1);
  EXPECT_EQ(last, 50U);
  jobs.push_back([] { throw std::invalid_argument("this one"); });
  EXPECT_THROW(RunJobs(jobs, 2), std::invalid_argument);
}

TEST(Cylinder, AFolderWithoutRecordingsIsRefusedWithItsName) {
  testing::TemporaryFolder folder;
  try {
    (void)ReadCylinder(folder.path());
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder.path().string()));
  }
}

// Real measurements: the declared physics, F = A p and a seal friction that grows with pressure.
TEST(Cylinder, TheGreyBoxFindsTheAreaOfThePistonInMeasuredData) {
  const std::filesystem::path folder =
      std::filesystem::path(SINEW_SHARED_DIR) / "data" / "pneumatic_cylinder_3dprinted";
  SKIP_WITHOUT_DATA(folder);
  const std::vector<types::Run> runs = ReadCylinder(folder);
  ASSERT_GE(runs.size(), 6U);
  const networks::Samples samples = networks::MakeSamples(
      networks::MakeTable(runs, {.task = Task::kForce, .period_s = 0.04, .blocks = 2}));
  Eigen::MatrixXd predicted;
  const networks::GreyBox model = networks::FitGreyBox(Task::kForce, samples, &predicted);
  // A piston of 25 mm: 49.1 N a bar.
  EXPECT_NEAR(model.coefficients(0), 49.1, 2.0);
  EXPECT_LT(networks::MeanSquare(samples, predicted, samples.test), 0.002);
}

}  // namespace
}  // namespace sinew::tools
