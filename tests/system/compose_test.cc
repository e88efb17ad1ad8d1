// The provider and its chain as one process: the same topics, handed over like processes. Domains
// 107 and 108.
#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "components/topics/node/node.h"
#include "tests/support/program.h"
#include "tests/support/realtime.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recorded_messages.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kComposedRig = SINEW_SOURCE_DIR "/robots/rig/";

// As a deployment says it.
std::string RealtimeSetting() {
  return std::string("realtime_priority=") + (MayBecomeRealtime() ? "true" : "false");
}

TEST(Compose, OneProcessDrivesTheRigWithTheSameTopics) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "run.mcap";
  const Finished run =
      testing::Run({kSinew, "compose", kComposedRig + "deploy_esn.yaml", "--duration", "6",
                    "--domain", "107", "--record", file.string(), "--set", RealtimeSetting()},
                   60s);
  ASSERT_EQ(run.exit_code, 0) << run.output << run.error;

  const auto recording = PayloadsByTopic(file);
  std::map<std::string, std::uint32_t> process;
  for (const auto& status : MessagesOf<msg::ComponentStatus>(recording, "component_status")) {
    process[status.name] = status.process_id;
  }
  for (const char* name : {"pneumatics", "regime", "reference", "esn", "rls", "control"}) {
    EXPECT_EQ(process[name], process["surrogate"]) << name;
  }
  EXPECT_NE(process["logger"], process["surrogate"]);

  std::map<std::uint64_t, msg::JointState> states;
  for (const auto& state : MessagesOf<msg::JointState>(recording, "joint_state")) {
    states[state.header.tick] = state;
  }
  // Each command answers its tick, with the reference and the prediction of that tick.
  std::size_t good = 0;
  double largest_error_rad = 0.0;
  const auto commands = MessagesOf<msg::JointCommand>(recording, "joint_command");
  for (const auto& command : commands) {
    const std::uint64_t tick = command.header.tick;
    if (tick < 3 * 240 || !states.contains(tick)) continue;
    EXPECT_EQ(command.reference_tick, tick);
    EXPECT_EQ(command.prediction_tick, tick);
    EXPECT_FALSE(command.stale) << "tick " << tick;
    largest_error_rad = std::max(largest_error_rad,
                                 std::abs(command.position_rad[0] - states[tick].position_rad[0]));
    ++good;
  }
  EXPECT_GT(good, 2 * 240u);
  EXPECT_LT(largest_error_rad, 0.05);
  for (const char* topic : {"reference", "regime", "torque_prediction", "reservoir_state",
                            "readout", "valve_command", "pneumatic_state"}) {
    EXPECT_GT(recording.at(topic).size(), recording.at("joint_state").size() / 2) << topic;
  }
}

// Whose joint commands the provider obeys.
class SourceWatch {
 public:
  explicit SourceWatch(int domain)
      : node_(WatchOptions(domain)), reader_(node_.MakeReader(node::kCommandSource)) {}
  bool WaitFor(const std::string& participant) {
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < deadline) {
      while (const auto source = reader_.TakeNext()) {
        if (source->joint_command_participant == participant) return true;
      }
      node_.WaitForData(20ms);
    }
    return false;
  }

 private:
  static node::Options WatchOptions(int domain) {
    node::Options options;
    options.component = options.name = "observer";
    options.domain_id = domain;
    return options;
  }
  node::Node node_;
  node::Reader<msg::CommandSource> reader_;
};

TEST(Compose, AComposedControllerIsHandedOverAndTakesOverFromTheDead) {
  SourceWatch source(108);
  const Program rig({kSinew, "compose", kComposedRig + "deploy_esn.yaml", "--duration", "0",
                     "--domain", "108", "--set", RealtimeSetting()});
  ASSERT_TRUE(source.WaitFor("control")) << rig.error();
  std::vector<std::string> line{SINEW_BIN_DIR "/sinew-control",
                                "--config",
                                kComposedRig + "control_pid_linear.yaml",
                                "--name",
                                "other",
                                "--domain",
                                "108"};
  if (MayBecomeRealtime()) line.push_back("--realtime");
  const Program other(line);
  const Finished handover =
      testing::Run({kSinew, "handover", "control", "other", "--timeout", "15", "--domain", "108"});
  ASSERT_EQ(handover.exit_code, 0) << handover.error << other.error();
  ASSERT_TRUE(source.WaitFor("other"));
  other.Signal(SIGKILL);
  ASSERT_TRUE(source.WaitFor("control"));
}

}  // namespace
}  // namespace sinew::testing
