// The files of sinew-logger as processes over DDS: split, by writer, around a fault, on a full
// disk, with attachments, recovered. Domains 202 to 205.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

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
#include "tests/components/record/logger/messages.h"
#include "tests/support/program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using testing::Finished;
using ::testing::HasSubstr;
using testing::Program;

const std::string kFilesBin = std::string(SINEW_BIN_DIR) + "/";

class LoggerFiles : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  // A recording of so many ticks of 4 ms.
  std::string ImportTicks(int rows) {
    std::string csv = "t,q\n";
    for (int row = 0; row < rows; ++row) {
      csv += std::to_string(0.004 * row) + "," + std::to_string(row) + "\n";
    }
    const std::string map = folder_.Write(
        "map.yaml",
        "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\nsignals:\n"
        "  position: {column: q, unit: rad}\n");
    const Finished run = testing::Run({kFilesBin + "sinew", "import", folder_.Write("d.csv", csv),
                                       "--map", map, "--out", Path("imported.mcap")});
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return Path("imported.mcap");
  }

  testing::TemporaryFolder folder_;
};

struct FileFacts {
  bool whole = false;
  std::vector<std::uint64_t> ticks;  // of joint_state
  std::map<std::string, recording::TextMap> metadata;
};

FileFacts ReadFacts(const std::string& path) {
  recording::FileSource source(path);
  const recording::McapReader reader(source);
  FileFacts facts;
  facts.whole = !reader.recovery();
  for (const recording::McapMetadata& metadata : reader.ReadMetadata()) {
    facts.metadata[metadata.name] = metadata.values;
  }
  recording::MessageFilter filter;
  filter.topics = std::set<std::string>{"joint_state"};
  recording::McapMessages messages = reader.Messages(filter);
  recording::McapMessage message;
  while (messages.Next(&message)) {
    facts.ticks.push_back(
        static_cast<std::uint64_t>(testing::FieldOf("joint_state", message.data, "header.tick")));
  }
  return facts;
}

// True as soon as the condition holds; false after the limit.
template <class Condition>
bool HoldsWithin(std::chrono::seconds limit, Condition condition) {
  const auto give_up = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
  }
  return true;
}

bool HasMessages(const std::string& path, std::uint64_t count) {
  try {
    recording::FileSource source(path);
    return recording::McapReader(source).statistics().message_count >= count;
  } catch (const std::exception&) {  // not there yet
    return false;
  }
}

TEST_F(LoggerFiles, OneLoggerWritesARecordingAndASecondIsRefused) {
  const std::string out = Path("run.mcap");
  const std::vector<std::string> command = {kFilesBin + "sinew-logger",
                                            "--domain",
                                            "202",
                                            "--out",
                                            out,
                                            "--overwrite",
                                            "--attach",
                                            "a\x1b[2J\n=" + folder_.Write("notes.txt", "text")};
  Program first(command);
  ASSERT_TRUE(
      HoldsWithin(20s, [&first] { return first.error().find("domain") != std::string::npos; }));
  ASSERT_TRUE(HoldsWithin(20s, [&out] { return HasMessages(out, 0); })) << first.error();
  const Finished second = testing::Run(command, 20s);
  EXPECT_EQ(second.exit_code, 2) << second.error;
  EXPECT_THAT(second.error,
              HasSubstr(out + ": is being written by another process, expected another name\n"));
  first.Signal(SIGINT);
  EXPECT_EQ(first.Wait(20s), 0) << first.error();
  EXPECT_TRUE(ReadFacts(out).whole);
  const Finished list = testing::Run({kFilesBin + "sinew", "attachments", out}, 20s);
  EXPECT_EQ(list.exit_code, 0) << list.error;
  EXPECT_THAT(list.output, HasSubstr(" a\\u001b[2J\\n\n"));
}

TEST_F(LoggerFiles, ASplitRecordingLosesNothingAndNamesItsWriters) {
  const std::string imported = ImportTicks(3000);
  Program logger({kFilesBin + "sinew-logger", "--lockstep", "--domain", "202", "--out",
                  Path("run.mcap"), "--split-size", "600k", "--compression", "none", "--exclude",
                  "component_.*|log"});
  Program player({kFilesBin + "sinew-player", imported, "--lockstep", "--domain", "202", "--await",
                  "recording_progress:64", "--name", "some_player"});
  EXPECT_EQ(player.Wait(60s), 0) << player.error();
  EXPECT_EQ(logger.Wait(20s), 0) << logger.error();
  std::vector<std::uint64_t> ticks;
  int number = 0;
  const auto name = [this](int of) {
    return Path((of < 10 ? "run_00" : "run_0") + std::to_string(of) + ".mcap");
  };
  for (; std::filesystem::exists(name(number)); ++number) {
    const std::string file = name(number);
    const FileFacts facts = ReadFacts(file);
    EXPECT_TRUE(facts.whole) << file;
    EXPECT_EQ(facts.metadata.at("sinew.losses").at("all.missing"), "0");
    EXPECT_EQ(facts.metadata.at("sinew.recording").at("domain_id"), "202");
    ticks.insert(ticks.end(), facts.ticks.begin(), facts.ticks.end());
    const Finished list = testing::Run({kFilesBin + "sinew", "list", file, "--json"});
    const auto report = nlohmann::json::parse(list.output);
    EXPECT_GE(report["topics"].size(), 1u) << "joint_state of the imported file";
    for (const auto& topic : report["topics"]) {
      EXPECT_EQ(topic["writer"], "some_player");
      EXPECT_NE(topic["name"], "component_status");
    }
  }
  EXPECT_GE(number, 3);
  ASSERT_EQ(ticks.size(), 3000u);
  for (std::size_t i = 0; i < ticks.size(); ++i) ASSERT_EQ(ticks[i], i);
}

TEST_F(LoggerFiles, AFaultOfAComponentIsWrittenWithWhatCameBeforeIt) {
  const std::string imported = ImportTicks(20000);
  Program all(
      {kFilesBin + "sinew-logger", "--domain", "203", "--out", Path("all.mcap"), "--name", "all"});
  Program ring({kFilesBin + "sinew-logger", "--domain", "203", "--out", Path("fault.mcap"),
                "--last", "1s", "--on-fault", "--after", "0s", "--name", "ring"});
  Program player({kFilesBin + "sinew-player", imported, "--domain", "203", "--wait-readers", "2"});
  ASSERT_TRUE(HoldsWithin(40s, [&] { return HasMessages(Path("all.mcap"), 1000); }))
      << all.error() << player.error();
  EXPECT_FALSE(std::filesystem::exists(Path("fault_000.mcap"))) << "nothing has happened";
  // A recorder that may write no more than 200 KiB (400 blocks) goes to fault.
  const Finished limited =
      testing::Run({"sh", "-c",
                    "ulimit -f 400; trap '' XFSZ; exec " + kFilesBin +
                        "sinew-logger --domain 203 --compression none --name limited --out " +
                        Path("limited.mcap")},
                   30s);
  EXPECT_EQ(limited.exit_code, 1) << limited.error;
  ASSERT_TRUE(ring.WaitForText("fault_000.mcap", 20s)) << ring.error();
  ASSERT_TRUE(HoldsWithin(20s, [&] {
    return HasMessages(Path("fault_000.mcap"), 1) && ReadFacts(Path("fault_000.mcap")).whole;
  }));
  ring.Signal(SIGUSR1);  // and once more on request
  ASSERT_TRUE(HoldsWithin(20s, [&] {
    return HasMessages(Path("fault_001.mcap"), 1) && ReadFacts(Path("fault_001.mcap")).whole;
  })) << ring.error();
  for (Program* program : {&ring, &all, &player}) program->Signal(SIGINT);
  EXPECT_EQ(ring.Wait(10s), 0) << ring.error();
  EXPECT_EQ(all.Wait(10s), 0) << all.error();
  EXPECT_EQ(player.Wait(10s), 0) << player.error();

  const FileFacts fault = ReadFacts(Path("fault_000.mcap"));
  EXPECT_THAT(fault.metadata.at("sinew.trigger").at("reason"),
              HasSubstr("component_status: 'limited' is in fault: " + Path("limited.mcap") +
                        ": cannot be written: File too large"));
  // The last second at 250 Hz, and no more than that; a loaded machine may deliver fewer.
  EXPECT_GT(fault.ticks.size(), 100u);
  EXPECT_LE(fault.ticks.back() - fault.ticks.front(), 320u);
  const FileFacts request = ReadFacts(Path("fault_001.mcap"));
  EXPECT_EQ(request.metadata.at("sinew.trigger").at("reason"), "SIGUSR1");
}

TEST_F(LoggerFiles, InLockstepAFullDiskDoesNotStopTheProvider) {
  SKIP_WITHOUT_KERNEL(std::filesystem::exists("/dev/full"), "/dev/full");
  const std::string imported = ImportTicks(2000);
  Program logger({kFilesBin + "sinew-logger", "--lockstep", "--domain", "204", "--out", "/dev/full",
                  "--overwrite"});
  Program player({kFilesBin + "sinew-player", imported, "--lockstep", "--domain", "204", "--await",
                  "recording_progress:64", "--wait-readers", "1"});
  EXPECT_EQ(player.Wait(60s), 0) << player.error();
  EXPECT_EQ(logger.Wait(30s), 1);
  EXPECT_THAT(logger.error() + logger.output(),
              HasSubstr("/dev/full: cannot be written: No space left on device"));
}

TEST_F(LoggerFiles, ARecordingCarriesItsFilesAlsoWhenItIsCutOff) {
  const std::string yaml = folder_.Write("rig.yaml", "a: 1\n");
  const std::string run = Path("run.mcap");
  Program logger({kFilesBin + "sinew-logger", "--domain", "205", "--out", run, "--attach",
                  "models/rig.yaml=" + yaml, "--compression", "lz4"});
  ASSERT_TRUE(HoldsWithin(20s, [&] { return HasMessages(run, 1); })) << logger.error();
  logger.Signal(SIGKILL);
  EXPECT_EQ(logger.Wait(10s), -SIGKILL);

  const std::string whole = Path("whole.mcap");
  const Finished recovered =
      testing::Run({kFilesBin + "sinew", "recover", run, "--out", whole, "--json"});
  ASSERT_EQ(recovered.exit_code, 0) << recovered.error;
  EXPECT_GE(nlohmann::json::parse(recovered.output)["messages"], 1);
  const FileFacts facts = ReadFacts(whole);
  EXPECT_TRUE(facts.whole);
  EXPECT_EQ(facts.metadata.at("sinew.recording").at("clock"), "CLOCK_REALTIME");
  // sha256sum of "a: 1\n".
  EXPECT_EQ(facts.metadata.at("sinew.files").at("models/rig.yaml"),
            "sha256:" + testing::Run({"sha256sum", yaml}).output.substr(0, 64));
  EXPECT_TRUE(facts.metadata.contains("sinew.recovered"));

  const Finished list = testing::Run({kFilesBin + "sinew", "attachments", whole});
  EXPECT_THAT(list.output, HasSubstr("models/rig.yaml"));
  const Finished out = testing::Run(
      {kFilesBin + "sinew", "attachments", whole, "models/rig.yaml", "--out", Path("back.yaml")});
  EXPECT_EQ(out.exit_code, 0) << out.error;
  EXPECT_EQ(config::ReadFile(Path("back.yaml")), "a: 1\n");

  const auto refused = [](const std::vector<std::string>& line, const std::string& what) {
    const Finished finished = testing::Run(line);
    EXPECT_EQ(finished.exit_code, 2);
    EXPECT_THAT(finished.error, HasSubstr(what));
  };
  const std::string sinew = kFilesBin + "sinew";
  refused({sinew, "recover", whole, "--out", Path("x.mcap")}, "is whole");
  refused({sinew, "recover", yaml, "--out", Path("x.mcap")}, "no MCAP file");
  refused({sinew, "recover", run, "--out", whole}, "is there already");
  refused({sinew, "attachments", whole, "rig.yaml"}, "expected one of: models/rig.yaml");
  refused({sinew, "attachments", whole, "models/rig.yaml", "--out", Path("back.yaml")},
          "is there already");
  refused({sinew + "-logger", "--domain", "205", "--out", Path("x.mcap"), "--attach", Path("none")},
          "cannot be read");
  refused(
      {sinew + "-logger", "--domain", "205", "--out", Path("x.mcap"), "--split-duration", "1 week"},
      "--split");
  refused({sinew + "-logger", "--domain", "205", "--out", Path("x.mcap"), "--on-fault"}, "--last");
  refused({sinew + "-logger", "--domain", "205", "--out", Path("x.mcap"), "--compression", "gzip"},
          "--compression");
  EXPECT_FALSE(std::filesystem::exists(Path("x.mcap")));
}

}  // namespace
}  // namespace sinew
