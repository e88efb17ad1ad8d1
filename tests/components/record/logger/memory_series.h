// The files of a recording in memory.
#pragma once

#include <mutex>
#include <vector>

#include "components/record/logger/recording_sink.h"
#include "components/record/recording/bytes.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::testing {

// Thread: the recorder writes, the test reads between.
class MemorySeries final : public logger::RecordingSink {
 public:
  // capacity: bytes of all files together, like a disk.
  explicit MemorySeries(std::size_t capacity = ~std::size_t{0}) : capacity_(capacity) {}
  recording::IoStatus Begin(int number) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (static_cast<std::size_t>(number) != files_.size()) {
      return recording::IoStatus::Failed("another number than the next one");
    }
    files_.emplace_back();
    return recording::IoStatus::Ok();
  }
  recording::IoStatus Write(std::span<const std::byte> bytes) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bytes.size() > capacity_) return recording::IoStatus::Failed("No space left on device");
    capacity_ -= bytes.size();
    files_.back().insert(files_.back().end(), bytes.begin(), bytes.end());
    return recording::IoStatus::Ok();
  }
  recording::IoStatus Sync() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++syncs_;
    return recording::IoStatus::Ok();
  }
  recording::IoStatus End() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++ended_;
    return recording::IoStatus::Ok();
  }
  std::vector<recording::Bytes> files() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return files_;
  }
  int syncs() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return syncs_;
  }
  std::size_t ended() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return ended_;
  }

 private:
  mutable std::mutex mutex_;
  std::size_t capacity_;
  std::vector<recording::Bytes> files_;
  int syncs_ = 0;
  std::size_t ended_ = 0;
};

}  // namespace sinew::testing
