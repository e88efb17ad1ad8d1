#include "components/robot/estop/latch_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace sinew::estop {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(LatchFile, IsNotLatchedWhereThereIsNoFile) {
  const testing::TemporaryFolder folder;
  EXPECT_FALSE(LatchFile(folder.path() / "latch").Read().latched);
}

TEST(LatchFile, KeepsTheReasonInOneLineUntilItIsRemoved) {
  const testing::TemporaryFolder folder;
  const LatchFile latch(folder.path() / "latch");
  EXPECT_THAT(latch.Write("hand\nin the\x01 gear\n"), IsEmpty());
  const LatchFile::State state = LatchFile(latch.path()).Read();
  EXPECT_TRUE(state.latched);
  EXPECT_TRUE(state.valid);
  EXPECT_EQ(state.why, "hand\\nin the\\u0001 gear");
  EXPECT_THAT(latch.Remove(), IsEmpty());
  EXPECT_FALSE(LatchFile(latch.path()).Read().latched);
  EXPECT_THAT(latch.Remove(), IsEmpty()) << "removed already";
}

TEST(LatchFile, EveryDoubtCountsAsLatched) {
  const testing::TemporaryFolder folder;
  const auto why = [](const std::filesystem::path& path) {
    const LatchFile::State state = LatchFile(path).Read();
    EXPECT_TRUE(state.latched) << path;
    EXPECT_FALSE(state.valid) << path;
    return state.why;
  };
  EXPECT_THAT(why(folder.Write("empty", "")), HasSubstr("unexpected contents"));
  EXPECT_THAT(why(folder.Write("other", "sinew-estop-latch/2\n")),
              HasSubstr("unexpected contents"));
  EXPECT_THAT(why(folder.Write("cut", "sinew-estop")), HasSubstr("unexpected contents"));
  EXPECT_THAT(why(folder.path()), HasSubstr("is a folder"));
  EXPECT_THAT(why(folder.path() / "not mounted" / "latch"), HasSubstr("cannot be read"));
  EXPECT_THAT(why(std::filesystem::path(folder.Write("file", "")) / "latch"),
              HasSubstr("cannot be read"));
  ASSERT_EQ(::symlink("loop", (folder.path() / "loop").c_str()), 0);
  EXPECT_THAT(why(folder.path() / "loop"), HasSubstr("cannot be read"));
}

TEST(LatchFile, ReportsWhatItCannotWriteOrRemove) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(LatchFile(folder.path() / "not there" / "latch").Write("x"),
              HasSubstr("cannot be written"));
  EXPECT_THAT(LatchFile(folder.path() / "not there" / "latch").Remove(), HasSubstr("not there"));
  EXPECT_THAT(LatchFile(folder.path()).Remove(), HasSubstr("cannot be removed"));
}

}  // namespace
}  // namespace sinew::estop
