// The two tiny ends a recording is written to and read from. Files: file/file_io.h; tests use
// memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sinew::recording {

// What became of reading or writing. Empty message: done, wholly.
class [[nodiscard]] IoStatus {
 public:
  static IoStatus Ok() { return IoStatus{}; }
  static IoStatus Failed(std::string message) {
    IoStatus status;
    status.message_ = std::move(message);
    return status;
  }
  bool ok() const noexcept { return message_.empty(); }
  const std::string& message() const noexcept { return message_; }  // "no space left on device"

 private:
  std::string message_;
};

// Takes bytes in order. A short write is a failure.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  virtual IoStatus Write(std::span<const std::byte> bytes) = 0;
};

// Gives bytes from anywhere. A short read is a failure.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  virtual IoStatus Read(std::uint64_t offset, std::span<std::byte> bytes) = 0;
};

class MemorySink : public ByteSink {
 public:
  IoStatus Write(std::span<const std::byte> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return IoStatus::Ok();
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

// Does not own the bytes.
class MemorySource : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::uint64_t size() const override { return bytes_.size(); }
  IoStatus Read(std::uint64_t offset, std::span<std::byte> bytes) override {
    if (offset > bytes_.size() || bytes.size() > bytes_.size() - offset) {
      return IoStatus::Failed("read past the end");
    }
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
    return IoStatus::Ok();
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace sinew::recording
