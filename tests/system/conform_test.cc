// Every participant and stand-in of the project keeps the contract of its role. Domains 68, 76, 79.
#include "tools/conform/conform.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "components/topics/node/topics.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/conform/run_all.h"
#include "tools/conform/robot.h"
#include "tools/conform/role.h"

namespace sinew::conform {
namespace {

const std::vector<int> kDomains = {68, 76, 79};
const std::string kRig = SINEW_SOURCE_DIR "/robots/rig/";

struct Subject {
  std::string role, program, config;  // config: in robots/rig; empty: none
};

const Subject kSubjects[] = {
    {"pneumatics", "sinew-pneumatics", "pneumatics.yaml"},
    {"pneumatics", "sinew-ideal-pressure", "pneumatics.yaml"},
    {"regime", "sinew-regime", "regime.yaml"},
    {"regime", "sinew-regime", "regime_active.yaml"},
    {"regime", "sinew-regime-truth", ""},
    {"reference", "sinew-reference", "reference_benchmark.yaml"},
    {"esn", "sinew-esn", "esn.yaml"},
    {"esn", "sinew-esn", "esn_adaptive.yaml"},
    {"esn", "sinew-inverse-dynamics", "esn_model.yaml"},
    {"rls", "sinew-rls", "rls.yaml"},
    {"rls", "sinew-frozen-readout", "rls.yaml"},
    {"control", "sinew-control", "control_pid_model.yaml"},
    {"control", "sinew-control", "control_pid_esn.yaml"},
    {"control", "sinew-control", "control_position.yaml"},
    {"residual", "sinew-residual", "residual.yaml"},
    {"performance", "sinew-performance", "performance.yaml"},
};

// A second of a played reference as a recording, and the configuration that names it.
std::filesystem::path WriteRecordedReference(const std::filesystem::path& folder) {
  constexpr std::uint64_t kTicks = 240;
  recording::FileSink sink(folder / "run.mcap", recording::Existing::kReplace);
  recording::McapWriter writer(sink);
  EXPECT_TRUE(writer.Open().ok());
  std::map<std::string, recording::ChannelId> channels;
  for (const char* name : {"joint_state", "reference"}) {
    const node::TopicInfo& topic = *node::FindTopic(name);
    const recording::TopicSchema schema{topic.name, topic.type_name, topic.idl, topic.idl_hash};
    EXPECT_TRUE(recording::AddTopic(schema, &writer, &channels[name]).ok());
  }
  Moment moment{.session_id = 9, .period_s = 1.0 / static_cast<double>(kTicks)};
  for (; moment.tick < kTicks; ++moment.tick) {
    const auto time_ns =
        static_cast<std::int64_t>(1e9 * moment.period_s) * static_cast<std::int64_t>(moment.tick);
    for (const auto& [name, channel] : channels) {
      EXPECT_TRUE(writer.WriteMessage(channel, time_ns, time_ns, PlayedMessage(name, moment)).ok());
    }
  }
  EXPECT_TRUE(writer.Close().ok() && sink.Close().ok());
  const std::filesystem::path config = folder / "recorded_reference.yaml";
  std::ofstream(config) << "schema: sinew-recorded-reference/1\nrecording: run.mcap\n";
  return config;
}

// The programs of a role side by side, each in its own domain.
class Conform : public ::testing::TestWithParam<std::string> {};

TEST_P(Conform, ProgramsKeepTheContractOfTheRole) {
  const testing::TemporaryFolder folder;
  std::vector<Options> all;
  const auto add = [&all](const std::string& program, const std::string& config) {
    Options options;
    options.role = GetParam();
    options.program = std::string(SINEW_BIN_DIR) + "/" + program;
    if (!config.empty()) options.arguments = {"--config", config};
    all.push_back(options);
  };
  for (const Subject& subject : kSubjects) {
    if (subject.role != GetParam()) continue;
    add(subject.program, subject.config.empty() ? "" : kRig + subject.config);
  }
  if (GetParam() == "reference") {
    add("sinew-recorded-reference", WriteRecordedReference(folder.path()).string());
  }
  ASSERT_FALSE(all.empty());
  const auto passed = [](std::size_t, const Report& report) { return report.passed(); };
  for (const Report& report : RunAll(all, kDomains, passed)) {
    std::ostringstream table;
    Print(report, table);
    EXPECT_TRUE(report.passed()) << table.str();
    EXPECT_EQ(report.rows.size(), CheckNames().size()) << table.str();
    std::printf("%s", table.str().c_str());
  }
}

INSTANTIATE_TEST_SUITE_P(Roles, Conform, ::testing::ValuesIn(RoleNames()),
                         [](const auto& role) { return role.param; });

}  // namespace
}  // namespace sinew::conform
