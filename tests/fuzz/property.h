// What every harness here is built from: bytes read as choices, and properties that must hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "bridge/can/frame.h"

namespace sinew::fuzz {

// A property that did not hold. libFuzzer's entry lets it end the process.
struct Violation : std::logic_error {
  using std::logic_error::logic_error;
};

inline void Check(bool holds, const char* what) {
  if (!holds) throw Violation(what);
}

// "3#R8", "12345678x#0102": for messages.
std::string Text(const can::Frame& frame);

// Bytes of an input from the front; zeros when they have run out.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> data) : data_(data) {}

  bool empty() const { return at_ >= data_.size(); }
  std::uint8_t Byte() { return at_ < data_.size() ? data_[at_++] : std::uint8_t{0}; }
  template <class Integer>
  Integer Take() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
      value |= static_cast<std::uint64_t>(Byte()) << (8 * i);
    return static_cast<Integer>(value);
  }
  // Any classic frame, impossible ones included: flags, length, identifier, data; 14 bytes.
  can::Frame Frame() {
    can::Frame frame;
    const std::uint8_t flags = Byte();
    frame.extended = (flags & 1) != 0;
    frame.remote = (flags & 2) != 0;
    frame.error = (flags & 4) != 0;
    frame.length = Byte();
    frame.id = Take<std::uint32_t>();
    for (std::size_t i = 0; i < can::kMaxDataBytes; ++i) frame.data[i] = Byte();
    return frame;
  }

 private:
  std::span<const std::uint8_t> data_;
  std::size_t at_ = 0;
};

// The bytes that Bytes::Frame reads as this frame.
void Append(std::vector<std::uint8_t>& bytes, const can::Frame& frame);

}  // namespace sinew::fuzz
