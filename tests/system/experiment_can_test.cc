// An experiment of the rig between processes in real time: CAN bridge, virtual axes and a person at
// the link. Oracle: what the axes are made of. Domain 158.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/experiment_result.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

const std::string kExperimentBin = SINEW_BIN_DIR "/";
const std::string kRigFolder = SINEW_SOURCE_DIR "/robots/rig/";

// Limits of the bus's watchdogs are wide: a loaded machine stalls a
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
