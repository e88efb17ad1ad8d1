// Files of a recording on disk, and files that it carries.
#include "components/record/logger/file/file_series.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "components/record/logger/file/attached_file.h"
#include "tests/support/temporary_folder.h"

namespace sinew::logger {
namespace {

using recording::Existing;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

void WriteText(FileSeries* series, int number, const std::string& text) {
  ASSERT_TRUE(series->Begin(number).ok());
  ASSERT_TRUE(series->Write(std::as_bytes(std::span(text))).ok());
  ASSERT_TRUE(series->Sync().ok());
  ASSERT_TRUE(series->End().ok());
}

template <class Call>
std::string ErrorOf(Call call) {
  try {
    call();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FileSeries, IsTheFileAsNamedOrNumberedOnes) {
  const TemporaryFolder folder;
  FileSeries one(folder.path() / "one.mcap", false, Existing::kRefuse);
  WriteText(&one, 0, "a");
  EXPECT_EQ(config::ReadFile(folder.path() / "one.mcap"), "a");
  EXPECT_FALSE(one.Begin(1).ok());

  FileSeries many(folder.path() / "run.mcap", true, Existing::kRefuse);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "run_000.mcap")) << "not before its Begin";
  WriteText(&many, 0, "b");
  WriteText(&many, 1, "c");
  EXPECT_EQ(many.current(), folder.path() / "run_001.mcap");
  EXPECT_EQ(config::ReadFile(folder.path() / "run_000.mcap"), "b");
  EXPECT_EQ(config::ReadFile(folder.path() / "run_001.mcap"), "c");
  EXPECT_EQ(FileSeries::Numbered("a/run.mcap", 1234), "a/run_1234.mcap");
}

TEST(FileSeries, RefusesAnOlderSeriesOrReplacesAllOfIt) {
  const TemporaryFolder folder;
  for (const char* name : {"run_000.mcap", "run_001.mcap", "run_002.mcap", "other_000.mcap"}) {
    folder.Write(name, "old");
  }
  const std::filesystem::path path = folder.path() / "run.mcap";
  EXPECT_THAT(ErrorOf([&] { FileSeries(path, true, Existing::kRefuse); }),
              HasSubstr("run_000.mcap: is there already"));
  FileSeries series(path, true, Existing::kReplace);
  WriteText(&series, 0, "new");
  EXPECT_EQ(config::ReadFile(folder.path() / "run_000.mcap"), "new");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "run_002.mcap"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "other_000.mcap"));
}

TEST(FileSeries, LooksAtAllNumbers) {
  const TemporaryFolder folder;
  for (const char* name : {"run_002.mcap", "run_1000.mcap", "run_01.mcap", "run_0a1.mcap"}) {
    folder.Write(name, "old");
  }
  const std::filesystem::path path = folder.path() / "run.mcap";
  EXPECT_EQ(FileSeries::FilesOf(path).size(), 2u);
  EXPECT_THAT(ErrorOf([&] { FileSeries(path, true, Existing::kRefuse); }),
              HasSubstr("run_002.mcap: is there already"));
  const FileSeries series(path, true, Existing::kReplace);
  EXPECT_TRUE(FileSeries::FilesOf(path).empty());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "run_01.mcap"));
}

TEST(FileSeries, RemovesNothingThatIsNoFileOrIsBeingWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "run.mcap";
  FileSeries first(path, true, Existing::kRefuse);
  WriteText(&first, 0, "whole");
  ASSERT_TRUE(first.Begin(1).ok());
  EXPECT_THAT(ErrorOf([&] { FileSeries(path, true, Existing::kReplace); }),
              HasSubstr("run_001.mcap: is being written by another process"));
  EXPECT_EQ(config::ReadFile(folder.path() / "run_000.mcap"), "whole");
  ASSERT_TRUE(first.End().ok());
  std::filesystem::create_symlink("/dev/null", folder.path() / "run_002.mcap");
  EXPECT_THAT(ErrorOf([&] { FileSeries(path, true, Existing::kReplace); }),
              HasSubstr("run_002.mcap: is no plain file"));
  EXPECT_EQ(FileSeries::FilesOf(path).size(), 3u);
}

TEST(FileSeries, ReportsAFolderThatIsNotThereAndAFileInTheWay) {
  const TemporaryFolder folder;
  for (const bool numbered : {false, true}) {
    EXPECT_THAT(
        ErrorOf([&] { FileSeries(folder.path() / "no/run.mcap", numbered, Existing::kRefuse); }),
        HasSubstr("cannot be written"));
  }
  FileSeries series(folder.path() / "run.mcap", true, Existing::kRefuse);
  WriteText(&series, 0, "a");
  folder.Write("run_001.mcap", "of somebody else");
  EXPECT_THAT(series.Begin(1).message(), HasSubstr("run_001.mcap: is there already"));
}

TEST(AttachedFile, HasNameTypeContentAndHash) {
  const TemporaryFolder folder;
  const std::string file = folder.Write("rig.yaml", "abc");
  const AttachedFile plain = ReadAttachedFile(file);
  EXPECT_EQ(plain.name, "rig.yaml");
  EXPECT_EQ(plain.attachment.data, "abc");
  EXPECT_EQ(plain.attachment.media_type, "application/yaml");
  // FIPS 180-2, appendix B.1: the hash of "abc".
  EXPECT_EQ(plain.sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(ReadAttachedFile("models/a.yaml=" + file).name, "models/a.yaml");
  const std::string equals = folder.Write("a=b.bin", "");
  EXPECT_EQ(ReadAttachedFile(equals).name, "a=b.bin");
  EXPECT_EQ(ReadAttachedFile(equals).attachment.media_type, "application/octet-stream");
}

TEST(AttachedFile, OfALargeFileIsTheHashAlone) {
  const TemporaryFolder folder;
  const std::string file = folder.Write("weights.bin", std::string(kLargestAttachment + 1, 'x'));
  const AttachedFile large = ReadAttachedFile(file);
  EXPECT_FALSE(large.attached);
  EXPECT_EQ(large.bytes, kLargestAttachment + 1);
  EXPECT_EQ(large.sha256.size(), 64u);
  EXPECT_TRUE(large.attachment.data.empty());
}

TEST(AttachedFile, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf([&] { (void)ReadAttachedFile(folder.path()); }), HasSubstr("cannot be read"));
  EXPECT_THAT(ErrorOf([&] { (void)ReadAttachedFile("a=/no/file"); }),
              HasSubstr("--attach: /no/file"));
}

}  // namespace
}  // namespace sinew::logger
