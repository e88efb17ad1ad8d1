#include "reproduction/training_sets/training_sets.h"

#include <gtest/gtest.h>

#include <cmath>

#include "components/learn/esn/normal.h"
#include "reproduction/networks/samples.h"

namespace sinew::reproduction {
namespace {

using networks::Task;

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

}  // namespace
}  // namespace sinew::reproduction
