#include "components/record/logger/file/file_series.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "components/base/config/config.h"

namespace sinew::logger {

namespace fs = std::filesystem;
using recording::IoStatus;

FileSeries::FileSeries(fs::path path, bool numbered, recording::Existing existing)
    : path_(std::move(path)), numbered_(numbered), existing_(existing), current_(path_) {
  if (!numbered_) {
    file_.emplace(path_, existing_);
    return;
  }
  const fs::path first = Numbered(path_, 0);
  const fs::path folder = first.has_parent_path() ? first.parent_path() : fs::path(".");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw UsageError(first.string() + ": cannot be written: " + std::strerror(errno));
  }
  if (!fs::exists(first)) return;
  if (existing_ == recording::Existing::kRefuse) {
    throw UsageError(first.string() + ": is there already, expected a new name (or --overwrite)");
  }
  for (int number = 0; fs::remove(Numbered(path_, number)); ++number) {
  }
}

fs::path FileSeries::Numbered(const fs::path& path, int number) {
  char text[16];
  std::snprintf(text, sizeof(text), "_%03d", number);
  return path.parent_path() / (path.stem().string() + text + path.extension().string());
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
    file_.emplace(current_, existing_);
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
