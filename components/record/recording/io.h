// The two tiny ends a recording is written to and read from. Files: file/file_io.h; tests use
// memory (tests/support/memory_io.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

namespace sinew::recording {

// Outcome of reading or writing. Empty message: done, wholly.
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

}  // namespace sinew::recording
