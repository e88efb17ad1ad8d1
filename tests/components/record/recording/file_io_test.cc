#include "components/record/recording/file/file_io.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "components/base/config/config.h"
#include "components/record/recording/mcap_writer.h"
#include "tests/support/skip.h"

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
  const fs::path path = fs::path(testing::TempDir()) / "file_io_refuse.mcap";
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

TEST(FileSink, NamesTheFileThatCannotBeMade) {
  EXPECT_THROW(FileSink("/no/such/folder/x.mcap", Existing::kReplace), UsageError);
  EXPECT_THROW(FileSource("/no/such/file.mcap"), UsageError);
  EXPECT_THROW(FileSource{testing::TempDir()}, UsageError);
}

TEST(WholeFileSink, LeavesTheOldFileUntilItIsCommitted) {
  const fs::path path = fs::path(testing::TempDir()) / "file_io_whole.mcap";
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
