// A position in a CDR payload that moves by the type of what is read. Internal to cdr.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "components/record/recording/cdr.h"

namespace sinew::recording {

inline constexpr std::size_t kCdrHeaderSize = 4;

template <class T>
T SwapBytes(T value) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  std::reverse(bytes.begin(), bytes.end());
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

// Reads the 4-byte header: true when numbers are in the other byte order.
bool ReadCdrHeader(std::span<const std::byte> payload);

// Walks a payload; position counts from the start of the payload. What does not fit throws
// CdrError.
class CdrWalker {
 public:
  CdrWalker(std::span<const std::byte> payload, bool swapped)
      : payload_(payload), swapped_(swapped) {}

  std::size_t position() const { return position_; }

  // Position of a number of that size.
  std::size_t Align(std::size_t size) {
    if (size > 1)
      position_ = kCdrHeaderSize + (position_ - kCdrHeaderSize + size - 1) / size * size;
    return position_;
  }
  void Advance(std::uint64_t size) {
    if (position_ > payload_.size() || size > payload_.size() - position_) {
      throw CdrError("the payload of " + std::to_string(payload_.size()) + " bytes ends early");
    }
    position_ += static_cast<std::size_t>(size);
  }
  template <class T>
  T Get() {
    const std::size_t at = Align(sizeof(T));
    Advance(sizeof(T));
    T value;
    std::memcpy(&value, payload_.data() + at, sizeof(T));
    return swapped_ ? SwapBytes(value) : value;
  }
  // A text with its NUL; within its bound.
  std::string_view GetText(const IdlType& type);
  // Elements of an array (by its type) or a sequence (read here).
  std::uint32_t GetCount(const IdlType& type);
  void SkipElements(const IdlType& element, std::uint32_t count);
  void Skip(const IdlType& type);

 private:
  std::span<const std::byte> payload_;
  bool swapped_;
  std::size_t position_ = kCdrHeaderSize;
};

}  // namespace sinew::recording
