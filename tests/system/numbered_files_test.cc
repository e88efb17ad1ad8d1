// Each file of a numbered recording is read alone: what came before it and is still valid is in it,
// and the state of every component, so that components are run again from there. Domains 217, 218.
#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/snapshot.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recorded_messages.h"

namespace sinew::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

const fs::path kNumberedRig = fs::path(SINEW_SOURCE_DIR) / "robots/rig";
const std::set<std::string> kComponents = {"pneumatics", "regime", "reference",
                                           "esn",        "rls",    "control"};

// Whole, with so many messages at least.
bool IsWhole(const fs::path& file, std::uint64_t messages) {
  try {
    recording::FileSource source(file);
    const recording::McapReader reader(source);
    return !reader.recovery() && reader.statistics().message_count >= messages;
  } catch (const std::exception&) {  // not there yet
    return false;
  }
}

template <class Condition>
bool BecomesTrue(std::chrono::seconds limit, Condition condition) {
  const auto give_up = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
  }
  return true;
}

// Names of the components whose state is in the file from a tick of the file on.
std::set<std::string> ComponentsWithState(const fs::path& file, std::uint64_t first_tick) {
  std::set<std::string> names;
  const auto payloads = PayloadsByTopic(file);
  if (!payloads.contains("component_snapshot")) return names;
  for (const auto& part : MessagesOf<msg::ComponentSnapshot>(payloads, "component_snapshot")) {
    if (part.header.tick < first_tick || part.part + 1 != part.part_count) continue;
    names.insert(part.name);
  }
  return names;
}

std::uint64_t FirstTick(const fs::path& file) {
  const auto payloads = PayloadsByTopic(file);
  node::HeadOfMessage head;
  const std::string& first = payloads.at("joint_state").front();
  EXPECT_TRUE(
      node::PeekHead(reinterpret_cast<const std::byte*>(first.data()), first.size(), &head));
  return head.tick;
}

// Topics that the file has messages of, with the participants that wrote them.
std::map<std::string, std::set<std::string>> WritersIn(const fs::path& file) {
  const Finished list = testing::Run({kSinew, "list", file.string(), "--json"});
  EXPECT_EQ(list.exit_code, 0) << list.error;
  std::map<std::string, std::set<std::string>> writers;
  const auto report = nlohmann::json::parse(list.output);
  for (const auto& row : report["topics"]) {
    if (row["messages"] > 0) writers[row["name"]].insert(row["writer"].get<std::string>());
  }
  return writers;
}

TEST(NumberedFilesOfTheRig, AreReadAndRunAgainOneByOne) {
  const TemporaryFolder folder;
  const fs::path rig = folder.path() / "rig";
  fs::copy(kNumberedRig, rig, fs::copy_options::recursive);
  const fs::path out = folder.path() / "run.mcap", second = folder.path() / "run_001.mcap";
  config::WriteFileAtomically(
      rig / "deploy_numbered.yaml",
      config::ReadFile(rig / "deploy_esn.yaml") +
          "  - {name: logger, program: sinew-logger, arguments: [--split-size, 1500k]}\n");
  const Finished recorded = testing::Run(
      {kSinew, "launch", (rig / "deploy_numbered.yaml").string(), "--set", "mode=lockstep",
       "--duration", "4", "--domain", "217", "--record", out.string()},
      120s);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.output << recorded.error;
  ASSERT_TRUE(IsWhole(second, 1000)) << recorded.output;

  const std::uint64_t first_tick = FirstTick(second);
  EXPECT_GT(first_tick, 64u);
  EXPECT_EQ(ComponentsWithState(second, first_tick), kComponents);
  const auto writers = WritersIn(second);
  ASSERT_TRUE(writers.contains("command_source")) << "sent once, when the session began";
  EXPECT_EQ(writers.at("command_source"), (std::set<std::string>{"surrogate"}));
  ASSERT_TRUE(writers.contains("component_status"));
  for (const std::string& name : kComponents) {
    EXPECT_TRUE(writers.at("component_status").contains(name)) << name;
  }
  // From the last states of the file, which is the whole of it but for its beginning.
  const Finished again = testing::Run({kSinew, "rerun", second.string(), "--from", "1000"}, 60s);
  EXPECT_EQ(again.exit_code, 0) << again.output << again.error;
  for (const std::string& name : kComponents) {
    EXPECT_NE(again.output.find(name + ": identical; from the snapshot of tick "),
              std::string::npos)
        << again.output;
  }
}

TEST(NumberedFilesOfTheRig, OfARingHaveWhatTheRingHasForgotten) {
  const TemporaryFolder folder;
  const fs::path all = folder.path() / "all.mcap", fault = folder.path() / "fault_000.mcap";
  const std::string logger = std::string(SINEW_BIN_DIR) + "/sinew-logger";
  Program ring({logger, "--domain", "218", "--out", (folder.path() / "fault.mcap").string(),
                "--last", "1s", "--after", "0s", "--name", "ring"});
  Program states({logger, "--domain", "218", "--out", all.string(), "--topics", "joint_state",
                  "--name", "states"});
  Program rig({kSinew, "launch", (kNumberedRig / "deploy_esn.yaml").string(), "--duration", "20",
               "--domain", "218"});
  const auto has_states = [&all] {
    try {
      recording::FileSource source(all);
      return recording::McapReader(source).statistics().message_count >= 600;  // 2.5 s
    } catch (const std::exception&) {
      return false;
    }
  };
  ASSERT_TRUE(BecomesTrue(60s, has_states)) << rig.output() << rig.error();
  ring.Signal(SIGUSR1);
  ASSERT_TRUE(BecomesTrue(20s, [&fault] { return IsWhole(fault, 100); })) << ring.error();
  for (Program* program : {&rig, &ring, &states}) program->Signal(SIGINT);
  for (Program* program : {&rig, &ring, &states}) EXPECT_EQ(program->Wait(20s), 0);

  const std::uint64_t first_tick = FirstTick(fault);
  EXPECT_GT(first_tick, 0u);
  EXPECT_EQ(ComponentsWithState(fault, first_tick), kComponents);
  const auto writers = WritersIn(fault);
  ASSERT_TRUE(writers.contains("command_source")) << "sent once, when the session began";
  EXPECT_EQ(writers.at("command_source"), (std::set<std::string>{"surrogate"}));
}

}  // namespace
}  // namespace sinew::testing
