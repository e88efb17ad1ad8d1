// `sinew doctor` on one host about a participant on another one: it is found, and the clocks are
// compared. Domain 208.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/faketime.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"
#include "tests/support/test_host.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr auto kDoctorLimit = 30s;

std::vector<std::string> ParticipantOfTheOtherHost() {
  return {std::string(SINEW_BIN_DIR) + "/sinew-reference",
          "--config",
          std::string(SINEW_SOURCE_DIR) + "/robots/rig/reference_benchmark.yaml",
          "--domain",
          "208",
          "--interface",
          "wire0"};
}

nlohmann::json FindingOf(const nlohmann::json& report, const std::string& check) {
  for (const nlohmann::json& finding : report["findings"]) {
    if (finding["check"] == check) return finding;
  }
  return nlohmann::json::object();
}

// The report of host 1, once it has compared a clock and the finding has this severity; else the
// last one.
nlohmann::json AskDoctor(const TwoHosts& hosts, const std::string& severity) {
  nlohmann::json report;
  const auto limit = std::chrono::steady_clock::now() + kDoctorLimit;
  do {
    const Finished doctor =
        testing::Run(hosts.On(1, {kSinew, "doctor", "--domain", "208", "--interface", "wire0",
                                  "--wait", "2.5", "--recordings", "/", "--json"}));
    report = nlohmann::json::parse(doctor.output, nullptr, false);
    if (!report.contains("findings")) return {{"findings", {}}, {"error", doctor.error}};
    const nlohmann::json clocks = FindingOf(report, "clocks");
    if (clocks.value("severity", "") == severity &&
        clocks.value("text", "").find("host '") != std::string::npos) {
      break;
    }
  } while (std::chrono::steady_clock::now() < limit);
  return report;
}

TEST(DoctorBetweenHosts, FindsAParticipantOfAnotherHostWhoseClockAgrees) {
  const TwoHosts hosts;
  SKIP_WITHOUT_KERNEL(hosts.why_not().empty(), hosts.why_not());
  Program reference(hosts.On(0, ParticipantOfTheOtherHost()));
  const nlohmann::json report = AskDoctor(hosts, "ok");
  const nlohmann::json clocks = FindingOf(report, "clocks");
  EXPECT_EQ(clocks.value("severity", ""), "ok") << report.dump(1) << reference.error();
  EXPECT_THAT(clocks.value("text", ""), HasSubstr("host '" + TwoHosts::Name(0) + "': messages"));
  EXPECT_THAT(FindingOf(report, "matching").value("text", ""), HasSubstr("participants: 1,"));
}

TEST(DoctorBetweenHosts, NamesHostOffsetAndRemedyOfAWrongClock) {
  const TwoHosts hosts;
  SKIP_WITHOUT_KERNEL(hosts.why_not().empty(), hosts.why_not());
  SKIP_WITHOUT_PACKAGE(!FakeTimeLibrary().empty(), "libfaketime");
  struct Case {
    const char* shift_s;
    const char* format;  // of the finding, with the offset in ms
  };
  const std::string host = "the clock of host '" + TwoHosts::Name(0) + "' is ";
  const std::string ahead = host + "ahead of this one by at least %lf ms";
  const std::string behind = host + "behind this one by at most %lf ms";
  for (const Case& shifted : {Case{"+2", ahead.c_str()}, Case{"-2", behind.c_str()}}) {
    std::vector<std::string> line = ParticipantOfTheOtherHost();
    const std::vector<std::string> clock = WithClock(shifted.shift_s);
    line.insert(line.begin(), clock.begin(), clock.end());
    Program reference(hosts.On(0, line));
    const nlohmann::json report = AskDoctor(hosts, "warning");
    const nlohmann::json clocks = FindingOf(report, "clocks");
    EXPECT_EQ(clocks.value("severity", ""), "warning") << report.dump(1) << reference.error();
    double offset_ms = 0.0;
    EXPECT_EQ(std::sscanf(clocks.value("text", "").c_str(), shifted.format, &offset_ms), 1)
        << clocks.dump() << reference.error();
    // The delay of a loaded machine is between the two; a second is far above it.
    EXPECT_NEAR(offset_ms, 2000.0, 1000.0);
    EXPECT_THAT(clocks.value("advice", ""), HasSubstr("chrony"));
  }
}

}  // namespace
}  // namespace sinew::testing
