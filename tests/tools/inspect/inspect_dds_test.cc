// hz, list, echo, graph and doctor on the rig that runs in real time, and of a recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "tests/support/patient_guard.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr auto kInspectLimit = 60s;
const std::string kInspectBin = std::string(SINEW_BIN_DIR) + "/";
const std::string kInspectRig = std::string(SINEW_SOURCE_DIR) + "/robots/rig/";

// The rig in real time at 100 Hz, which a loaded machine keeps up with.
class RunningRig : public ::testing::Test {
 protected:
  explicit RunningRig(const std::string& domain = "207")
      : domain_(domain),
        surrogate_({kInspectBin + "sinew-surrogate", "--config", PatientSurrogate(folder_),
                    "--domain", domain, "--rate", "100"}),
        pneumatics_(Line("sinew-pneumatics", "pneumatics.yaml")),
        reference_(Line("sinew-reference", "reference_benchmark.yaml")),
        control_(Line("sinew-control", "control_pid.yaml")) {}

  std::vector<std::string> Line(const std::string& program, const std::string& config) const {
    return {kInspectBin + program, "--config", kInspectRig + config, "--domain", domain_};
  }
  Finished Sinew(std::vector<std::string> words) const {
    words.insert(words.begin(), kSinew);
    words.insert(words.end(), {"--domain", domain_});
    return testing::Run(words, kInspectLimit);
  }
  // Until all four are seen.
  nlohmann::json List() const {
    nlohmann::json report;
    const auto end = std::chrono::steady_clock::now() + kInspectLimit;
    do {
      const Finished list = Sinew({"list", "--json"});
      report = nlohmann::json::parse(list.output, nullptr, false);
    } while (report["participants"].size() < 4 && std::chrono::steady_clock::now() < end);
    return report;
  }

  TemporaryFolder folder_;
  std::string domain_;
  Program surrogate_, pneumatics_, reference_, control_;
};

TEST_F(RunningRig, IsSeenByEveryCommand) {
  const nlohmann::json report = List();
  ASSERT_EQ(report["participants"].size(), 4u) << report.dump(1);
  EXPECT_TRUE(report["problems"].empty()) << report["problems"].dump(1);
  bool written = false;
  for (const auto& row : report["endpoints"]) {
    EXPECT_TRUE(row["unmatched"].empty()) << row.dump();
    if (row["topic"] != "joint_command" || row["role"] != "writer") continue;
    written = true;
    EXPECT_EQ(row["participant"], "control");
    EXPECT_THAT(row["qos"].get<std::string>(), StartsWith("best-effort, exclusive, deadline "));
    EXPECT_THAT(row["matched"].get<std::vector<std::string>>(), Contains("surrogate"));
    EXPECT_THAT(row["type"].get<std::string>(), StartsWith("sinew::msg::JointCommand_"));
  }
  EXPECT_TRUE(written);

  const Finished hz = Sinew({"hz", "joint_state", "joint_command", "--duration", "1", "--json"});
  ASSERT_EQ(hz.exit_code, 0) << hz.error;
  const auto rates = nlohmann::json::parse(hz.output);
  ASSERT_EQ(rates.size(), 2u) << hz.output;
  for (const auto& row : rates) {
    // A loaded machine slows the rig down: never above its rate.
    EXPECT_GT(row["rate_Hz"].get<double>(), 1.0) << row.dump();
    EXPECT_LT(row["rate_Hz"].get<double>(), 120.0) << row.dump();
    EXPECT_EQ(row["sessions"], 1);
    EXPECT_GT(row["delay_ms"]["mean"].get<double>(), 0.0);
    EXPECT_GE(row["age_ms"]["largest"].get<double>(), row["delay_ms"]["least"].get<double>());
    EXPECT_LT(row["age_ms"]["least"].get<double>(), 1000.0);
  }

  const Finished echo = Sinew({"echo", "joint_state", "-n", "1", "--json"});
  ASSERT_EQ(echo.exit_code, 0) << echo.error;
  EXPECT_EQ(nlohmann::json::parse(echo.output)["position_rad"].size(), 1u) << "the rig's joint";

  const Finished once = Sinew({"echo", "joint_state.position_rad", "--once", "--timeout", "60"});
  ASSERT_EQ(once.exit_code, 0) << once.error;
  EXPECT_EQ(nlohmann::json::parse(once.output).size(), 1u) << once.output;

  const std::string png = (folder_.path() / "q.png").string();
  const Finished plot =
      Sinew({"echo", "joint_state", "-n", "100", "--plot", "position_rad[0]", "--png", png});
  ASSERT_EQ(plot.exit_code, 0) << plot.error;
  EXPECT_THAT(plot.output, HasSubstr("position_rad[0]"));
  EXPECT_THAT(config::ReadFile(png), StartsWith("\x89PNG"));

  const std::string svg = (folder_.path() / "rig.svg").string();
  const Finished graph = Sinew({"graph", "--out", svg});
  ASSERT_EQ(graph.exit_code, 0) << graph.error;
  const std::string drawn = config::ReadFile(svg);
  for (const char* word : {"surrogate", "control", "reference", "joint_command"}) {
    EXPECT_THAT(drawn, HasSubstr(std::string(">") + word + "<"));
  }

  const std::string run = (folder_.path() / "run.mcap").string();
  const Finished record = Sinew({"record", "--out", run, "--duration", "2"});
  ASSERT_EQ(record.exit_code, 0) << record.error;
  const Finished recorded = testing::Run({kSinew, "hz", "joint_state", "--from", run, "--json"});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.error;
  const auto state = nlohmann::json::parse(recorded.output)[0];
  // The ticks of several participants in turn are no gaps.
  const Finished latched =
      testing::Run({kSinew, "hz", "component_status", "--from", run, "--json"});
  ASSERT_EQ(latched.exit_code, 0) << latched.error;
  const auto status = nlohmann::json::parse(latched.output)[0];
  EXPECT_GT(status["messages"], 4);
  EXPECT_TRUE(status["lost"].is_null()) << status.dump();
  EXPECT_EQ(status["repeated"], 0);
  EXPECT_GT(state["messages"], 1);
  EXPECT_FALSE(state["age_ms"].is_null()) << "stamps of a live simulation are epoch time";
  EXPECT_TRUE(state["delay_ms"].is_null()) << "when DDS sent it is not recorded";
  const Finished picture = testing::Run({kSinew, "graph", "--from", run});
  ASSERT_EQ(picture.exit_code, 0) << picture.error;
  EXPECT_THAT(picture.output, HasSubstr("\"p:surrogate\" -> \"t:joint_state\";")) << "not inferred";

  const Finished doctor = Sinew({"doctor", "--json", "--recordings", folder_.path().string()});
  const auto findings = nlohmann::json::parse(doctor.output)["findings"];
  std::map<std::string, std::string> severities;
  for (const auto& row : findings) severities[row["check"]] = row["severity"];
  EXPECT_EQ(severities["matching"], "ok") << findings.dump(1);
  EXPECT_EQ(severities["clocks"], "ok") << findings.dump(1);
  for (const char* check :
       {"shared_memory", "rtprio", "memlock", "cpu_governor", "disk_space", "can"}) {
    EXPECT_EQ(severities.count(check), 1u) << check;
  }
  for (Program* program : {&control_, &reference_, &pneumatics_, &surrogate_}) {
    program->Signal(SIGINT);
    EXPECT_EQ(program->Wait(kInspectLimit), 0) << program->error();
  }
}

TEST(Inspect, WrongRequestsAreOneLineAndExitCode2) {
  const TemporaryFolder folder;
  const auto expect = [](std::vector<std::string> words, const std::string& what) {
    words.insert(words.begin(), kSinew);
    const Finished run = testing::Run(words);
    EXPECT_EQ(run.exit_code, 2) << words[1] << run.error;
    EXPECT_THAT(run.error, HasSubstr(what));
  };
  const std::string text = folder.Write("text.mcap", "no recording");
  expect({"hz", "joints", "--domain", "209"}, "no topic 'joints'");
  expect({"hz", "--from", text}, "byte 0: no MCAP file");
  expect({"graph", "--from", text}, "byte 0: no MCAP file");
  expect({"echo", "joint_state", "--plot", "angle", "--domain", "209"}, "no field 'angle'");
  expect({"echo", "joint_state", "--png", "x.png", "--domain", "209"}, "--plot");
  expect({"doctor", "--offline", "--recordings", "/no/such/folder"}, "/no/such/folder");
}

TEST(Inspect, AnEmptyDomainHasNoMessageAndNoGraph) {
  EXPECT_EQ(testing::Run({kSinew, "hz", "--duration", "0.5", "--domain", "209"}).exit_code, 1);
  EXPECT_EQ(testing::Run({kSinew, "graph", "--wait", "0.5", "--domain", "209"}).exit_code, 1);
  const Finished once = testing::Run(
      {kSinew, "echo", "joint_state", "--once", "--timeout", "0.5", "--domain", "209"});
  EXPECT_EQ(once.exit_code, 1);
  EXPECT_EQ(once.output, "");
  EXPECT_THAT(once.error, HasSubstr("nothing on 'joint_state' in domain 209 for 0.5 s"));
}

}  // namespace
}  // namespace sinew::testing
