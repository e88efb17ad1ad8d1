// The biped on the ground with the PID gains that `sinew tune pid` found: through world, reference,
// control and performance as processes in lockstep it does what the trial in one process does.
// Domains 196 and 197.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/robot/control/file/control_file.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tools/tune_robot/tune_file.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kTunedFolder = SINEW_SOURCE_DIR "/robots/biped/";
constexpr double kSumsInAnotherOrder = 1e-9;  // relative; the trajectories are the same to the bit

// What sinew-performance counts of a recorded run: the robot of the one session.
nlohmann::json SquatThroughProcesses(int domain, const std::string& deployment,
                                     const std::vector<std::string>& more = {}) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string();
  std::vector<std::string> arguments{
      kSinew,     "launch", kTunedFolder + deployment, "--domain", std::to_string(domain),
      "--record", file};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = Run(arguments, 240s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  const Finished measured =
      Run({kSinew, "performance", file, "--config", kTunedFolder + "performance.yaml", "--json"});
  EXPECT_EQ(measured.exit_code, 0) << measured.error;
  return nlohmann::json::parse(measured.output).at(0).at("robot");
}

void ExpectSameRun(const nlohmann::json& processes, const tune::RobotTrialResult& trial) {
  ASSERT_FALSE(trial.score.fell_at_s.has_value());
  const auto expect = [&processes](const char* key, double in_process) {
    const double found = processes.at(key).get<double>();
    EXPECT_NEAR(found, in_process, kSumsInAnotherOrder * in_process) << key;
  };
  expect("mean_square_error_rad2", trial.score.mse_rad2);
  expect("positive_work_J", trial.performance.energies.positive_J);
  expect("net_work_J", trial.performance.energies.net_J);
  expect("electrical_J", trial.performance.drawn_J);
  expect("lifting_work_J", trial.performance.lifting_J);
}

TEST(BipedTuned, SquatsThroughTheProcessesAsInTheTrial) {
  tune::RobotTrialConfig trial = tune::LoadTune(kTunedFolder + "tune_pid.yaml").trial;
  trial.delay_ticks = 0;  // as in lockstep; the search has a tick
  trial.control = control::LoadControl(kTunedFolder + "control_pid_tuned.yaml").joints;
  const tune::RobotTrialResult alone = tune::RunRobotTrial(trial);
  EXPECT_LT(alone.score.mse_rad2, 1e-4) << "by hand: 1.9e-4";
  ExpectSameRun(
      SquatThroughProcesses(196, "deploy_biped.yaml",
                            {"--set", "control.config=" + kTunedFolder + "control_pid_tuned.yaml"}),
      alone);
}

TEST(BipedTuned, SquatsWithSeaPeaActuatorsAtThePressureThatPneumaticsHolds) {
  const tune::PressureSweepConfig sweep =
      tune::LoadPressureSweep(kTunedFolder + "tune_pressure.yaml");
  // world_sea_pea.yaml and pneumatics.yaml as they are shipped: what the deployment runs.
  const tune::RobotTrialResult alone = tune::RunRobotTrial(sweep.elastic);
  ExpectSameRun(SquatThroughProcesses(197, "deploy_biped_sea_pea.yaml"), alone);
}

}  // namespace
}  // namespace sinew::testing
