// A warning of a participant that runs: in `sinew log`, to who comes later, and in a recording.
// Domains 213, 215.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/node/node.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kLogLimit = 30s;
constexpr int kLogDomain = 213;
constexpr char kWarning[] = "topic 'operator_command': 1 of 1 samples were malformed and dropped";

// What the command prints, as soon as it has the text or the time is over.
std::string LogWith(const std::string& text, const std::vector<std::string>& words) {
  std::vector<std::string> command = {kSinew, "log"};
  command.insert(command.end(), words.begin(), words.end());
  const auto end = std::chrono::steady_clock::now() + kLogLimit;
  std::string output;
  do {
    output = testing::Run(command).output;
  } while (output.find(text) == std::string::npos && std::chrono::steady_clock::now() < end);
  return output;
}

TEST(Log, AWarningIsHeardLaterAndRecorded) {
  const TemporaryFolder folder;
  const std::string bin = std::string(SINEW_BIN_DIR) + "/", file = folder.path() / "run.mcap";
  const std::string domain = std::to_string(kLogDomain);
  Program surrogate({bin + "sinew-surrogate", "--domain", domain});
  Program logger({bin + "sinew-logger", "--domain", domain, "--out", file});

  node::Options options;
  options.component = options.name = "witness";
  options.domain_id = kLogDomain;
  node::Node witness(options);
  const node::RawWriter write = witness.MakeRawWriter(*node::FindTopic("operator_command"));
  // Both read it: without the logger the surrogate alone may not have been found yet.
  const auto end = std::chrono::steady_clock::now() + kLogLimit;
  while (write.matched_readers() < 2 && std::chrono::steady_clock::now() < end) {
    witness.WaitForData(20ms);
  }
  ASSERT_EQ(write.matched_readers(), 2);
  const std::array<std::byte, 8> no_command{};
  ASSERT_EQ(write(no_command.data(), no_command.size()), node::WriteStatus::kOk);
  ASSERT_TRUE(surrogate.WaitForText(kWarning, kLogLimit)) << surrogate.error();

  EXPECT_THAT(LogWith(kWarning, {"--once", "--level", "warn", "--domain", domain}),
              AllOf(HasSubstr(std::string(" warning  surrogate    ") + kWarning),
                    Not(HasSubstr(" info "))));
  EXPECT_THAT(LogWith("domain 213", {"--once", "--process", "logger", "--domain", domain}),
              AllOf(HasSubstr(" info     logger "), Not(HasSubstr("surrogate"))));
  EXPECT_THAT(LogWith(kWarning, {file}),
              AllOf(HasSubstr(kWarning), HasSubstr(" info     surrogate ")));
  logger.Signal(SIGINT);
  EXPECT_EQ(logger.Wait(kLogLimit), 0) << logger.error();
  const Finished list = testing::Run({kSinew, "list", file});
  EXPECT_THAT(list.output, AllOf(HasSubstr("not shown without --all: "), HasSubstr("log")));
  EXPECT_THAT(testing::Run({kSinew, "log", file, "--last", "1"}).output, HasSubstr("\n"));
}

TEST(Log, OfAProgramWhoseProfilesAreOlderIsNotSentAndItRuns) {
  std::string xml = config::ReadFile(SINEW_SOURCE_DIR "/components/topics/node/qos_profiles.xml");
  const std::string profile = "profile_name=\"lockstep\"";
  for (std::size_t at; (at = xml.find(profile)) != std::string::npos;) {
    xml.replace(at, profile.size(), "profile_name=\"other\"");
  }
  const TemporaryFolder folder;
  const std::string bin = std::string(SINEW_BIN_DIR) + "/", qos = folder.Write("qos.xml", xml);
  Program surrogate({bin + "sinew-surrogate", "--domain", "215", "--qos", qos});
  Program logger(
      {bin + "sinew-logger", "--domain", "215", "--qos", qos, "--out", folder.path() / "run.mcap"});
  for (Program* program : {&surrogate, &logger}) {
    EXPECT_TRUE(
        program->WaitForText("the log is not sent: no writer QoS profile 'lockstep'", kLogLimit))
        << program->error();
  }
  EXPECT_TRUE(logger.WaitForText("the log of others is not read: ", kLogLimit)) << logger.error();
  for (Program* program : {&logger, &surrogate}) {
    program->Signal(SIGINT);
    EXPECT_EQ(program->Wait(kLogLimit), 0) << program->error();
  }
}

}  // namespace
}  // namespace sinew::testing
