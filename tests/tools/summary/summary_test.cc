// tools/test_summary.py on result files as ctest writes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using sinew::testing::Finished;
using sinew::testing::TemporaryFolder;
using ::testing::EndsWith;
using ::testing::HasSubstr;

const std::string kGood = "<testcase name=\"good\" status=\"run\"><system-out/></testcase>";
const std::string kBad =
    "<testcase name=\"bad\" status=\"fail\"><failure message=\"\"/></testcase>";
const std::string kSkipped =
    "<testcase name=\"skipped\" status=\"notrun\">"
    "<skipped message=\"SKIP_REGULAR_EXPRESSION_MATCHED\"/>"
    "<system-out>x.cc:3: Skipped\npackage: zsh is not installed\n</system-out></testcase>";
const std::string kSkippedByAScript =
    "<testcase name=\"script\" status=\"notrun\"><skipped message=\"SKIP_RETURN_CODE=77\"/>"
    "<system-out>SKIPPED: data: no recording\n</system-out></testcase>";
const std::string kSkippedByTheKernel =
    "<testcase name=\"device\" status=\"notrun\">"
    "<skipped message=\"SKIP_REGULAR_EXPRESSION_MATCHED\"/>"
    "<system-out>x.cc:5: Skipped\nkernel: no /dev/full\n</system-out></testcase>";
const std::string kSkippedSilently =
    "<testcase name=\"silent\" status=\"notrun\"><skipped message=\"SKIP_RETURN_CODE=77\"/>"
    "<system-out/></testcase>";
const std::string kGone =
    "<testcase name=\"gone\" status=\"notrun\">"
    "<skipped message=\"Unable to find executable\"/></testcase>";

// What ctest wrote, and what the GoogleTest program `program` wrote.
Finished Summarize(const std::string& cases, const std::vector<std::string>& options = {},
                   const std::string& program = "") {
  const TemporaryFolder folder;
  if (!program.empty()) {
    folder.Write("test_results/program.xml",
                 "<testsuites><testsuite>" + program + "</testsuite></testsuites>");
  }
  std::vector<std::string> command = {"python3", SINEW_SOURCE_DIR "/tools/test_summary.py"};
  command.insert(command.end(), options.begin(), options.end());
  command.push_back(folder.Write("r.xml", "<testsuite>" + cases + "</testsuite>"));
  return testing::Run(command);
}

TEST(Summary, CountsWhatPassed) {
  const Finished run = Summarize(kGood + kGood);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.output, "2 passed, 0 failed, 0 skipped\n");
}

TEST(Summary, NamesFailuresAndFails) {
  const Finished run = Summarize(kGood + kBad);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.output, "FAILED: bad\n1 passed, 1 failed, 0 skipped\n");
}

TEST(Summary, PrintsWhyATestWasSkipped) {
  const Finished run = Summarize(kGood + kSkipped);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.output,
            "skipped: skipped: package: zsh is not installed\n1 passed, 0 failed, 1 skipped\n");
}

TEST(Summary, WhereSkipsFailATestWithoutItsPackageOrDataHasFailedAndSaysWhy) {
  const Finished run = Summarize(kGood + kSkipped + kSkippedByAScript, {"--skips-fail"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.output,
            "FAILED: skipped: skipped: package: zsh is not installed\n"
            "FAILED: script: skipped: data: no recording\n"
            "1 passed, 2 failed, 0 skipped\n");
}

TEST(Summary, WhereSkipsFailAKernelWithoutAFeatureIsExcused) {
  const Finished run = Summarize(kGood + kSkippedByTheKernel, {"--skips-fail"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.output, "skipped: device: kernel: no /dev/full\n1 passed, 0 failed, 1 skipped\n");
}

TEST(Summary, WhereSkipsFailASkipWithoutAReasonHasFailed) {
  const Finished run = Summarize(kGood + kSkippedSilently, {"--skips-fail"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.output,
            "FAILED: silent: skipped: no reason given\n1 passed, 1 failed, 0 skipped\n");
}

const std::string kProgramRan = R"(<testcase name="program" status="run"><system-out/></testcase>)";
const std::string kProgramFailed =
    R"(<testcase name="program" status="fail"><failure message=""/></testcase>)";
const std::string kGoodCase =
    R"(<testcase name="Good" classname="Suite" status="run" result="completed"/>)";
const std::string kBadCase =
    R"(<testcase name="Bad" classname="Suite" status="run" result="completed">)"
    R"(<failure message="x"/></testcase>)";
const std::string kSkippedCase =
    R"(<testcase name="Skipped" classname="Suite" status="run" result="skipped">)"
    R"(<skipped message="x.cc:3&#x0A;data: no recording"/></testcase>)";

TEST(Summary, CountsTheCasesOfAGoogleTestProgram) {
  EXPECT_EQ(Summarize(kGood + kProgramRan, {}, kGoodCase + kGoodCase).output,
            "3 passed, 0 failed, 0 skipped\n");
  EXPECT_EQ(Summarize(kProgramRan, {}, kGoodCase + kSkippedCase).output,
            "skipped: Suite.Skipped: data: no recording\n1 passed, 0 failed, 1 skipped\n");
  EXPECT_EQ(Summarize(kProgramRan, {"--skips-fail"}, kGoodCase + kSkippedCase).output,
            "FAILED: Suite.Skipped: skipped: data: no recording\n1 passed, 1 failed, 0 skipped\n");
}

TEST(Summary, NamesTheCaseThatFailedAndAProgramThatFailedWithoutOne) {
  const Finished run = Summarize(kProgramFailed, {}, kGoodCase + kBadCase);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.output, "FAILED: Suite.Bad\n1 passed, 1 failed, 0 skipped\n");
  EXPECT_EQ(Summarize(kProgramFailed, {}, kGoodCase).output,
            "FAILED: program\n1 passed, 1 failed, 0 skipped\n");
}

TEST(Summary, AProgramThatWroteNoResultIsOneCase) {
  EXPECT_EQ(Summarize(kProgramRan + kBad).output, "FAILED: bad\n1 passed, 1 failed, 0 skipped\n");
}

TEST(Summary, ATestWhoseProgramIsMissingHasFailed) {
  const Finished run = Summarize(kGood + kGone);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, EndsWith("1 passed, 1 failed, 0 skipped\n"));
}

TEST(Summary, NoTestsAtAllIsAFailure) {
  EXPECT_EQ(Summarize("").exit_code, 1);
  EXPECT_EQ(testing::Run({"python3", SINEW_SOURCE_DIR "/tools/test_summary.py"}).exit_code, 1);
}

TEST(Summary, AResultFileThatIsMissingOrBrokenIsAFailure) {
  const Finished run =
      testing::Run({"python3", SINEW_SOURCE_DIR "/tools/test_summary.py", "/nowhere/results.xml"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("/nowhere/results.xml: no result"));
  EXPECT_EQ(Summarize("<testcase").exit_code, 1);
}

}  // namespace
}  // namespace sinew
