#include "components/record/recording/file/file_io.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "components/base/config/config.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew::recording {
namespace {

namespace fs = std::filesystem;

TEST(FileSink, ReportsAFullDisk) {
  SKIP_WITHOUT_KERNEL(fs::exists("/dev/full"), "/dev/full");
  FileSink sink("/dev/full", Existing::kReplace);
  McapWriter writer(sink);
  const IoStatus status = writer.Open();
  EXPECT_FALSE(status.ok());
  EXPECT_EQ(status.message(), "No space left on device");
}

TEST(FileSink, RefusesToReplaceARecording) {
  const fs::path path = fs::path(::testing::TempDir()) / "file_io_refuse.mcap";
  config::WriteFileAtomically(path, "precious");
  try {
    FileSink sink(path, Existing::kRefuse);
    FAIL() << "replaced it";
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()),
              path.string() + ": is there already, expected a new name (or --overwrite)");
  }
  EXPECT_EQ(config::ReadFile(path), "precious");
  fs::remove(path);
}

TEST(FileSink, AFileHasOneWriterAtATime) {
  const testing::TemporaryFolder folder;
  const fs::path path = folder.path() / "run.mcap";
  const Bytes bytes = {std::byte{'a'}};
  FileSink first(path, Existing::kRefuse);
  ASSERT_TRUE(first.Write(bytes).ok());
  const auto refusal = [&path](const auto& call) {
    try {
      call();
    } catch (const UsageError& error) {
      return std::string(error.what()).substr(path.string().size());
    }
    return std::string("no error");
  };
  const char* expected = ": is being written by another process, expected another name";
  EXPECT_EQ(refusal([&] { FileSink(path, Existing::kReplace); }), expected);
  EXPECT_EQ(refusal([&] { RequireReplaceable(path); }), expected);
  EXPECT_EQ(config::ReadFile(path), "a") << "and is as it was";
  ASSERT_TRUE(first.Write(bytes).ok());
  ASSERT_TRUE(first.Close().ok());
  EXPECT_EQ(refusal([&] { RequireReplaceable(path); }), "no error");
  EXPECT_EQ(refusal([&] { FileSink(path, Existing::kReplace); }), "no error");
  EXPECT_EQ(config::ReadFile(path), "");
}

TEST(FileSink, NamesTheFileThatCannotBeMade) {
  EXPECT_THROW(FileSink("/no/such/folder/x.mcap", Existing::kReplace), UsageError);
  EXPECT_THROW(FileSource("/no/such/file.mcap"), UsageError);
  EXPECT_THROW(FileSource{::testing::TempDir()}, UsageError);
}

TEST(WholeFileSink, LeavesTheOldFileUntilItIsCommitted) {
  const fs::path path = fs::path(::testing::TempDir()) / "file_io_whole.mcap";
  config::WriteFileAtomically(path, "old");
  const Bytes bytes = {std::byte{'n'}, std::byte{'e'}, std::byte{'w'}};
  {
    WholeFileSink sink(path);
    ASSERT_TRUE(sink.Write(bytes).ok());
  }
  EXPECT_EQ(config::ReadFile(path), "old");
  {
    WholeFileSink sink(path);
    ASSERT_TRUE(sink.Write(bytes).ok());
    ASSERT_TRUE(sink.Commit().ok());
  }
  EXPECT_EQ(config::ReadFile(path), "new");
  fs::remove(path);
}

}  // namespace
}  // namespace sinew::recording
