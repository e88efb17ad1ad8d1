// tools/test_summary.py on result files as ctest writes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

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
    "<system-out>x.cc:3: Skipped\nzsh is not installed\n</system-out></testcase>";
const std::string kGone =
    "<testcase name=\"gone\" status=\"notrun\">"
    "<skipped message=\"Unable to find executable\"/></testcase>";

Finished Summarize(const std::string& cases) {
  const TemporaryFolder folder;
  const std::string file = folder.Write("r.xml", "<testsuite>" + cases + "</testsuite>");
  return testing::Run({"python3", SINEW_SOURCE_DIR "/tools/test_summary.py", file});
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

TEST(Summary, TellsWhyATestWasSkipped) {
  const Finished run = Summarize(kGood + kSkipped);
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.output, "skipped: skipped: zsh is not installed\n1 passed, 0 failed, 1 skipped\n");
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
