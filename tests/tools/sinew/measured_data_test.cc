// Measured data of other laboratories: each with a mapping and a model file of the project, nothing
// else. Skipped where the data are not there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "components/free_run/free_run.h"
#include "components/recording/file/run_reader.h"
#include "tools/sinew/close_loop.h"

namespace sinew::tools {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;

const fs::path kRobots = fs::path(SINEW_SOURCE_DIR) / "robots";
const fs::path kMeasured = fs::path(SINEW_SHARED_DIR) / "data";

std::vector<fs::path> Paths(const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<fs::path> paths;
  for (const std::string& name : names) paths.push_back(folder / (name + ".csv"));
  return paths;
}

#define SKIP_WITHOUT(folder) \
  if (!fs::exists(folder))   \
  GTEST_SKIP() << (folder) << " is not here: measured data lies beside the project"

// --- XL330 servo with a pendulum ---------------------------------------------------------------

const fs::path kPendulum = kMeasured / "bam_xl330_pendulum";

std::vector<fs::path> PendulumRuns(const std::vector<int>& gains) {
  std::vector<std::string> names;
  for (const int gain : gains) {
    for (const char* motion : {"lift_and_drop", "sin_sin", "sin_time_square", "up_and_down"}) {
      names.push_back("kp" + std::to_string(gain) + "_" + motion);
    }
  }
  return Paths(kPendulum, names);
}

CloseLoopResult OnPendulum(const std::vector<int>& train, int sealed) {
  CloseLoopOptions options;
  options.model = kRobots / "bam_xl330/model.yaml";
  options.map = kRobots / "bam_xl330/csv_map.yaml";
  options.train = PendulumRuns(train);
  options.sealed = PendulumRuns({sealed});
  return CloseLoop(options);
}

free_run::FreeRunResult FreeRunOnPendulum(const CloseLoopResult& result, int sealed) {
  std::vector<identify::Run> runs;
  for (const fs::path& path : PendulumRuns({sealed})) {
    runs.push_back(recording::ReadRuns(path, kRobots / "bam_xl330/csv_map.yaml").front());
  }
  const trace::TraceResult& trace = result.report.trace;
  return free_run::Compare(runs, trace.declared, trace.corrected, result.report.processing);
}

TEST(PendulumServo, LoadDependentGearFrictionIsFoundAndTheSimulationFollows) {
  SKIP_WITHOUT(kPendulum);
  const CloseLoopResult result = OnPendulum({100, 800}, 200);
  const trace::TraceResult& trace = result.report.trace;
  ASSERT_FALSE(trace.effects.empty());
  EXPECT_EQ(trace.effects[0].name, "load_dependent_friction");
  EXPECT_THAT(trace.effects[0].rivals, Contains("drive_efficiency_direction"));
  for (const trace::FoundEffect& effect : trace.effects) EXPECT_NE(effect.name, "stribeck");
  const free_run::FreeRunResult run = FreeRunOnPendulum(result, 200);
  ASSERT_TRUE(run.errors.has_value()) << run.why_not;
  EXPECT_EQ(run.errors->method, free_run::Method::kClosedLoop);
  // The servo's gain is not given: 4096 / 2 pi / (256 * 885) * 200 = 0.5755.
  EXPECT_NEAR(run.errors->after[0].servo_gain, 0.5755, 0.005);
  // Mean absolute error of the angle over all four motions, torque off and swinging included.
  EXPECT_LT(run.errors->after_mean_abs, 0.8 * run.errors->before_mean_abs);
  EXPECT_LT(run.errors->after_mean_abs, 0.05);
  EXPECT_EQ(run.errors->after_diverged, 0);
}

}  // namespace
}  // namespace sinew::tools
