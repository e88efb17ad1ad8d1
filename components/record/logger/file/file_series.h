// A recording as one file, or as numbered files: run.mcap, or run_000.mcap, run_001.mcap, ...
// Thread: one at a time.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

#include "components/record/logger/recording_sink.h"
#include "components/record/recording/file/file_io.h"

namespace sinew::logger {

class FileSeries final : public RecordingSink {
 public:
  // One file is made at once, of numbered ones each by its Begin. kReplace removes all
  // numbered files of an older recording. Throws UsageError when the file (of numbered ones: any)
  // is there and must not be replaced, is being written by another logger, or cannot be made there.
  FileSeries(std::filesystem::path path, bool numbered, recording::Existing existing);

  recording::IoStatus Begin(int number) override;
  recording::IoStatus Write(std::span<const std::byte> bytes) override;
  recording::IoStatus Sync() override;
  recording::IoStatus End() override;

  // The file begun last, before that the path as given. Any thread.
  std::filesystem::path current() const;
  // NAME_000.mcap for number 0.
  static std::filesystem::path Numbered(const std::filesystem::path& path, int number);
  // All that are there, whatever their numbers, in the order of their names.
  static std::vector<std::filesystem::path> FilesOf(const std::filesystem::path& path);

 private:
  const std::filesystem::path path_;
  const bool numbered_;
  std::optional<recording::FileSink> file_;
  bool folder_synced_ = false;  // since the file was made
  mutable std::mutex mutex_;
  std::filesystem::path current_;
};

}  // namespace sinew::logger
