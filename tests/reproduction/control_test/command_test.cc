// One trial of each kind over DDS, each participant a process.
#include <gtest/gtest.h>

#include <filesystem>

#include "reproduction/control_test/runner.h"

namespace sinew::control_test {
namespace {

namespace fs = std::filesystem;

RunnerConfig Config(const std::string& name) {
  RunnerConfig config;
  config.rig = fs::path(SINEW_SOURCE_DIR) / "robots/rig";
  config.model = config.rig / "surrogate_model_identified.yaml";
  config.folder = fs::path(::testing::TempDir()) / ("control_test_" + name);
  config.programs = SINEW_BIN_DIR;
  config.domain_id = 161;
  config.inverse_rounds = 5;
  fs::remove_all(config.folder);
  return config;
}

TEST(ControlTestOverDds, EachStrategyFollowsBetterThanTheOneBefore) {
  Runner runner(Config("arms"));
  double before_rad2 = 0.0051;  // published: PID
  for (const Arm arm : {Arm::kPid, Arm::kLinear, Arm::kNetwork}) {
    const Outcome outcome = runner.Run({arm, 4.0, Load::kNone, 2, 101});
    EXPECT_LT(outcome.score.whole.mean_square_error_rad2, 0.5 * before_rad2) << ArmTitle(arm);
    EXPECT_EQ(outcome.score.saturated_share, 0.0);
    before_rad2 = outcome.score.whole.mean_square_error_rad2;
  }
  const Outcome bound = runner.Run({Arm::kInverse, 4.0, Load::kNone, 2, 101});
  EXPECT_LT(bound.score.whole.mean_square_error_rad2, before_rad2);
}

TEST(ControlTestOverDds, ARunThatIsThereIsNotMadeAgain) {
  const RunnerConfig config = Config("again");
  const Trial trial{Arm::kPid, 4.0, Load::kNone, 2, 101};
  const double first_rad2 = Runner(config).Run(trial).score.whole.mean_square_error_rad2;
  const fs::path recording = config.folder / trial.name() / "run.mcap";
  const auto made = fs::last_write_time(recording);
  EXPECT_EQ(Runner(config).Run(trial).score.whole.mean_square_error_rad2, first_rad2);
  EXPECT_EQ(fs::last_write_time(recording), made);
}

}  // namespace
}  // namespace sinew::control_test
