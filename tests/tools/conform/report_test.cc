// Rows as a table and as JSON, and what counts as passed.
#include "tools/conform/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace sinew::conform {
namespace {

using ::testing::HasSubstr;

Report OneOfEach() {
  Report report;
  report.role = "control";
  report.program = "mine";
  report.Add("start", true, "active", "active");
  report.Add("sigterm", false, "exit code 0", "exit code 3");
  report.Skip("estop", "commands no joints");
  return report;
}

TEST(ConformReport, OneFailureFailsAndWhatIsNotApplicableDoesNot) {
  Report report;
  report.Skip("estop", "commands no joints");
  EXPECT_TRUE(report.passed());
  EXPECT_FALSE(OneOfEach().passed());
}

TEST(ConformReport, TheTableSaysWhatWasSeenAndOfFailuresWhatWasExpected) {
  std::ostringstream out;
  Print(OneOfEach(), out);
  EXPECT_THAT(out.str(), HasSubstr("FAIL"));
  EXPECT_THAT(out.str(), HasSubstr("exit code 3"));
  EXPECT_THAT(out.str(), HasSubstr("expected: exit code 0"));
  EXPECT_THAT(out.str(), HasSubstr("1 passed, 1 failed, 1 not applicable"));
}

TEST(ConformReport, JsonHasARowForEachCheck) {
  const nlohmann::ordered_json json = ToJson(OneOfEach());
  EXPECT_FALSE(json.at("passed").get<bool>());
  ASSERT_EQ(json.at("checks").size(), 3u);
  EXPECT_EQ(json.at("checks")[1].at("verdict"), "fail");
  EXPECT_EQ(json.at("checks")[2].at("verdict"), "not applicable");
}

}  // namespace
}  // namespace sinew::conform
