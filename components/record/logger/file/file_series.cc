#include "components/record/logger/file/file_series.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "components/base/config/config.h"
#include "components/base/types/text.h"

namespace sinew::logger {

namespace fs = std::filesystem;
using recording::IoStatus;

namespace {

constexpr std::size_t kLeastDigits = 3;

fs::path FolderOf(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

}  // namespace

FileSeries::FileSeries(fs::path path, bool numbered, recording::Existing existing)
    : path_(std::move(path)), numbered_(numbered), current_(path_) {
  if (!numbered_) {
    file_.emplace(path_, existing);
    return;
  }
  const fs::path first = Numbered(path_, 0);
  if (::access(FolderOf(path_).c_str(), W_OK | X_OK) != 0) {
    throw UsageError(first.string() + ": cannot be written: " + std::strerror(errno));
  }
  const std::vector<fs::path> before = FilesOf(path_);
  if (before.empty()) return;
  if (existing == recording::Existing::kRefuse) {
    throw UsageError(before.front().string() +
                     ": is there already, expected a new name (or --overwrite)");
  }
  for (const fs::path& file : before) recording::RequireReplaceable(file);
  for (const fs::path& file : before) fs::remove(file);
}

std::vector<fs::path> FileSeries::FilesOf(const fs::path& path) {
  const std::string stem = path.stem().string() + "_", extension = path.extension().string();
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(FolderOf(path), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(stem) || !name.ends_with(extension) ||
        name.size() < stem.size() + extension.size() + kLeastDigits) {
      continue;
    }
    const auto end = name.end() - static_cast<std::ptrdiff_t>(extension.size());
    if (std::all_of(name.begin() + static_cast<std::ptrdiff_t>(stem.size()), end,
                    [](char c) { return c >= '0' && c <= '9'; })) {
      files.push_back(path.parent_path() / name);
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

fs::path FileSeries::Numbered(const fs::path& path, int number) {
  return path.parent_path() /
         (path.stem().string() + types::Text("_%03d", number) + path.extension().string());
}

fs::path FileSeries::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return current_;
}

IoStatus FileSeries::Begin(int number) {
  folder_synced_ = false;
  if (!numbered_) {
    return number == 0 ? IoStatus::Ok() : IoStatus::Failed("one file, and another was begun");
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    current_ = Numbered(path_, number);
  }
  try {
    // Those of an older recording are gone: what is there by now is another logger's.
    file_.emplace(current_, recording::Existing::kRefuse);
  } catch (const UsageError& error) {
    return IoStatus::Failed(error.what());
  }
  return IoStatus::Ok();
}

IoStatus FileSeries::Write(std::span<const std::byte> bytes) { return file_->Write(bytes); }

IoStatus FileSeries::Sync() {
  if (!folder_synced_) {
    folder_synced_ = true;
    try {
      config::SyncFolderOf(current_);
    } catch (const UsageError& error) {
      return IoStatus::Failed(error.what());
    }
  }
  return file_->Sync();
}

IoStatus FileSeries::End() {
  IoStatus status = file_->Close();
  file_.reset();
  return status;
}

}  // namespace sinew::logger
