// The experiments of the rig between processes: `sinew experiment NAME --dds` on each state
// provider that has the topics: surrogate, world, and the CAN bridge with virtual axes and a person
// at the link. Oracle: what the provider is made of. Domains 150 to 160.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

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

double ValueOf(const json& result, const std::string& id) {
  for (const json& q : result.value("quantities", json::array())) {
    if (q.value("id", "") == id) return q.value("value", 0.0);
  }
  ADD_FAILURE() << "no " << id << " in " << result.dump();
  return 0.0;
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

// In real time, through frames. Limits of the bus's watchdogs are wide: a loaded machine stalls a
// process for a second now and then, and what is tested is what comes back.
TEST(ExperimentOverTopics, BacklashThroughTheCanBridgeWithAPersonAtTheLink) {
  const TemporaryFolder folder;
  const std::string bus = (folder.path() / "bus").string();
  const auto adapted = [&](const std::string& name,
                           const std::vector<std::pair<std::string, std::string>>& changes) {
    std::ostringstream stream;
    stream << std::ifstream(kRigFolder + name).rdbuf();
    std::string text = stream.str();
    for (const auto& [from, to] : changes) {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      if (at != std::string::npos) text.replace(at, from.size(), to);
    }
    return folder.Write(name, text);
  };
  const std::pair<std::string, std::string> ours{"transport: virtual",
                                                 "transport: virtual\n    bus: " + bus};
  // Where the experiment begins: no half minute of venting.
  (void)adapted("surrogate.yaml", {{"initial_pressure_bar: 4.0", "initial_pressure_bar: 1.617"}});
  const std::string axes_file =
      adapted("virtual_axes.yaml", {ours, {"watchdog_ms: 100", "watchdog_ms: 5000"}});
  const std::string bridge_file =
      adapted("can_bridge.yaml", {ours,
                                  {"lost_after_ms: 60", "lost_after_ms: 10000"},
                                  {"heartbeat_timeout_ms: 350", "heartbeat_timeout_ms: 10000"},
                                  {"fault_after_ms: 60", "fault_after_ms: 10000"}});
  Program bus_program({kExperimentBin + "sinew-can-bus", "--bus", bus});
  ASSERT_TRUE(bus_program.WaitForText("' at", 10s)) << bus_program.error();
  Program axes(
      {kExperimentBin + "sinew-virtual-axes", "--config", axes_file, "--hand", "--domain", "158"});
  ASSERT_TRUE(axes.WaitForText("sensor nodes", 10s)) << axes.error();
  Program bridge({kExperimentBin + "sinew-can-bridge", "--config", bridge_file, "--domain", "158"});
  const Finished run = testing::Run({kExperimentBin + "sinew", "experiment", "backlash", "--trials",
                                     "6", "--dds", "--arm", "--json", "--domain", "158"},
                                    120s);
  EXPECT_EQ(run.exit_code, 0) << run.error << bridge.error() << axes.error();
  const json result = json::parse(run.output, nullptr, false);
  ASSERT_TRUE(result.is_object()) << run.output << run.error;
  EXPECT_EQ(result.value("end", ""), "done") << bridge.error();
  EXPECT_NEAR(ValueOf(result, "backlash_deg"), 2.66, 0.05);
}

}  // namespace
}  // namespace sinew::testing
