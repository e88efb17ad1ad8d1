// `sinew list` on processes that run. Domains 41 and 231.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using sinew::testing::Finished;
using sinew::testing::Program;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr auto kListLimit = 30s;
const std::string kListBin = std::string(SINEW_BIN_DIR) + "/";

TEST(List, TwoParticipantsOfOneNameAreTwoRowsAndAProblem) {
  const std::vector<std::string> command = {
      kListBin + "sinew-reference", "--domain", "41", "--config",
      std::string(SINEW_SOURCE_DIR) + "/robots/rig/reference_benchmark.yaml"};
  Program first(command), second(command);
  nlohmann::json report;
  // A loaded machine starts programs slowly: until both are seen.
  const auto limit = std::chrono::steady_clock::now() + kListLimit;
  do {
    const Finished list =
        testing::Run({kListBin + "sinew", "list", "--domain", "41", "--json"}, kListLimit);
    ASSERT_TRUE(nlohmann::json::accept(list.output)) << list.error;
    report = nlohmann::json::parse(list.output);
  } while (report["participants"].size() < 2 && std::chrono::steady_clock::now() < limit);

  ASSERT_EQ(report["participants"].size(), 2u) << report.dump(1);
  for (const auto& row : report["participants"]) EXPECT_EQ(row["name"], "reference");
  EXPECT_NE(report["participants"][0]["process_id"], report["participants"][1]["process_id"]);
  EXPECT_THAT(report["problems"].get<std::vector<std::string>>(),
              Contains(HasSubstr("several participants are named 'reference'")));
  for (const auto& topic : report["topics"]) {
    if (topic["name"] != "reference") continue;
    EXPECT_EQ(topic["writers"], nlohmann::json::array({"reference", "reference"}));
  }
  for (Program* program : {&first, &second}) {
    program->Signal(SIGINT);
    EXPECT_EQ(program->Wait(kListLimit), 0) << program->error();
  }
}

// Fast DDS reports nothing of partitions that do not meet.
TEST(List, AReaderInAnotherPartitionIsBelowTheWriterWithTheReason) {
  std::ifstream profiles(std::string(SINEW_SOURCE_DIR) +
                         "/components/topics/node/qos_profiles.xml");
  std::string xml{std::istreambuf_iterator<char>(profiles), {}};
  const std::string qos = "<qos>";
  xml.insert(xml.find(qos, xml.find("<data_reader profile_name=\"state\">")) + qos.size(),
             "<partition><names><name>left</name></names></partition>");
  const testing::TemporaryFolder folder;
  Program provider({kListBin + "sinew-surrogate", "--domain", "231"});
  Program reference({kListBin + "sinew-reference", "--domain", "231", "--config",
                     std::string(SINEW_SOURCE_DIR) + "/robots/rig/reference_benchmark.yaml",
                     "--qos", folder.Write("qos.xml", xml)});
  const std::string expected =
      "\n  not matched: reference: partition: the writer is in the default partition, the reader "
      "in "
      "partition 'left'\n";
  Finished list;
  const auto limit = std::chrono::steady_clock::now() + kListLimit;
  do {
    list = testing::Run({kListBin + "sinew", "list", "--domain", "231"}, kListLimit);
  } while (list.output.find(expected) == std::string::npos &&
           std::chrono::steady_clock::now() < limit);
  EXPECT_THAT(list.output, HasSubstr(expected)) << list.error;
  EXPECT_THAT(list.output, HasSubstr("problem: topic 'joint_state': 'surrogate' is not heard by "
                                     "'reference': partition: "));
  EXPECT_EQ(list.exit_code, 1);
}

}  // namespace
}  // namespace sinew
