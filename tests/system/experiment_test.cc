// The experiments of the rig between processes in lockstep: `sinew experiment NAME --dds` on
// surrogate and world; experiment_can_test.cc has the CAN bridge. Oracle: what the provider is made
// of. Domains 150 to 157 and 159 to 160.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/experiment_result.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

const std::string kExperimentBin = SINEW_BIN_DIR "/";
const std::string kRigFolder = SINEW_SOURCE_DIR "/robots/rig/";
const std::string kAwaited = "joint_command,valve_command,sim_disturbance";

// Runs one experiment in lockstep with a simulation; its result.
json Measure(const std::string& provider, const std::string& config, int domain,
             const std::string& experiment, const std::vector<std::string>& more = {}) {
  Program simulation({kExperimentBin + provider, "--config", kRigFolder + config, "--lockstep",
                      "--domain", std::to_string(domain), "--await", kAwaited});
  std::vector<std::string> arguments{kExperimentBin + "sinew",
                                     "experiment",
                                     experiment,
                                     "--quick",
                                     "--dds",
                                     "--lockstep",
                                     "--arm",
                                     "--json",
                                     "--domain",
                                     std::to_string(domain),
                                     "--model",
                                     kRigFolder + "model.yaml"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = Run(arguments, 150s);
  EXPECT_EQ(run.exit_code, 0) << run.error << simulation.error();
  simulation.Signal(SIGTERM);
  EXPECT_EQ(simulation.Wait(10s), 0) << simulation.error();
  const json result = json::parse(run.output, nullptr, false);
  EXPECT_TRUE(result.is_object()) << run.output;
  if (!result.is_object()) return json::object();
  EXPECT_EQ(result.value("end", ""), "done");
  return result;
}

TEST(ExperimentOverTopics, BacklashOfTheSurrogate) {
  const json result = Measure("sinew-surrogate", "surrogate.yaml", 150, "backlash");
  EXPECT_NEAR(ValueOf(result, "backlash_deg"), 2.66, 0.05);
}

TEST(ExperimentOverTopics, PushesOfTheSurrogateGiveSlopeAndMovingFriction) {
  const json result = Measure("sinew-surrogate", "surrogate.yaml", 151, "moving-friction");
  EXPECT_NEAR(ValueOf(result, "pressure_slope_Nm_bar"), 0.3587, 0.02 * 0.3587);
  EXPECT_NEAR(ValueOf(result, "moving_friction_Nm"), 0.22, 0.05 * 0.22);
}

TEST(ExperimentOverTopics, MotorOnTheBenchGivesInertiaAndDamping) {
  const json result = Measure("sinew-surrogate", "surrogate_motor_bench.yaml", 152, "motor");
  EXPECT_NEAR(ValueOf(result, "rotor_inertia_kg_m2"), 1.15e-5, 0.05 * 1.15e-5);
  EXPECT_NEAR(ValueOf(result, "rotor_viscous_Nm_s_rad"), 3.1e-5, 0.05 * 3.1e-5);
}

TEST(ExperimentOverTopics, BreakawayCarriesTheLinkFromAngleToAngle) {
  const json result =
      Measure("sinew-surrogate", "surrogate.yaml", 153, "breakaway", {"--rest", "30"});
  EXPECT_NEAR(ValueOf(result, "static_friction_Nm"), 1.21, 0.05 * 1.21);
  EXPECT_NEAR(ValueOf(result, "gravity_Nm"), 0.58, 0.05 * 0.58);
}

TEST(ExperimentOverTopics, StiffnessFallsWithPressureUntilFrictionWins) {
  const json result = Measure("sinew-surrogate", "surrogate.yaml", 154, "stiffness");
  EXPECT_NEAR(ValueOf(result, "return_limit_bar"), (0.22 + 0.58) / 0.3587, 0.1);
  EXPECT_GT(ValueOf(result, "secant_6bar_Nm_rad"), 35.0);
  EXPECT_LT(ValueOf(result, "secant_6bar_Nm_rad"), 42.0);
}

TEST(ExperimentOverTopics, DataInsideTheBacklashArePushesOfAPersonAtTwoHertz) {
  const json result = Measure("sinew-surrogate", "surrogate.yaml", 159, "sea-data");
  EXPECT_NEAR(ValueOf(result, "pushes_Hz"), 2.0, 0.1);
  EXPECT_NEAR(ValueOf(result, "set_end_bar"), (0.22 + 0.58) / 0.3587, 0.15);
}

TEST(ExperimentOverTopics, DataOutsideTheBacklashKeepTheTeethInContact) {
  const json result = Measure("sinew-surrogate", "surrogate.yaml", 160, "pea-data");
  EXPECT_GT(ValueOf(result, "outside_share"), 0.95);
  EXPECT_LT(ValueOf(result, "lowest_deg"), -75.0);
  EXPECT_GT(ValueOf(result, "highest_deg"), 80.0);
}

TEST(ExperimentOverTopics, WhatIsRecordedIsWhatIsIdentifiedAndTheModelIsUpdated) {
  const TemporaryFolder folder;
  const std::string recording = (folder.path() / "backlash.mcap").string();
  const std::string model = (folder.path() / "model.yaml").string();
  const json result = Measure(
      "sinew-surrogate", "surrogate.yaml", 155, "backlash",
      {"--record", recording, "--update-model", model, "--out", (folder.path() / "out").string()});
  EXPECT_EQ(result.value("source", ""), "backlash.mcap");
  EXPECT_NEAR(ValueOf(result, "backlash_deg"), 2.66, 0.05);
  std::ostringstream text;
  text << std::ifstream(model).rdbuf();
  EXPECT_NE(text.str().find("backlash.mcap"), std::string::npos) << text.str();
  for (const char* file : {"section.json", "data.csv", "result.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "out" / file)) << file;
  }
}

TEST(ExperimentOverTopics, BacklashOfTheWorldIsThatOfItsModel) {
  const json result = Measure("sinew-world", "world.yaml", 156, "backlash");
  EXPECT_NEAR(ValueOf(result, "backlash_deg"), 2.66, 0.05);
}

TEST(ExperimentOverTopics, PushesOfTheWorldGiveTheFrictionOfItsModel) {
  const json result = Measure("sinew-world", "world.yaml", 157, "moving-friction");
  // The declared model has a spring: P (K - k1 (q - q0)) at the level link.
  const double slope_Nm_bar = 0.3587 + 4.0 * 0.16;
  EXPECT_NEAR(ValueOf(result, "pressure_slope_Nm_bar"), slope_Nm_bar, 0.02 * slope_Nm_bar);
  EXPECT_NEAR(ValueOf(result, "moving_friction_Nm"), 0.22, 0.05 * 0.22);
}

}  // namespace
}  // namespace sinew::testing
