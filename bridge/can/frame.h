// A classic CAN frame, as every codec, transport and test of this project passes it on.
//
// Plain data: 11-bit or 29-bit identifier, up to 8 bytes. CAN FD frames have no place in it: the
// motor controllers we drive have classic controllers.
#pragma once

#include <array>
#include <cstdint>

namespace sinew::can {

inline constexpr int kMaxDataBytes = 8;
inline constexpr std::uint32_t kMaxStandardId = 0x7FF;
inline constexpr std::uint32_t kMaxExtendedId = 0x1FFFFFFF;

struct Frame {
  std::uint32_t id = 0;
  bool extended = false;  // 29-bit identifier
  bool remote = false;    // asks for data; carries none, length is that of the data asked for
  bool error = false;     // not from the bus: a controller's report, id holds the error class bits
  std::uint8_t length = 0;
  std::array<std::uint8_t, kMaxDataBytes> data{};

  friend bool operator==(const Frame&, const Frame&) = default;
};

// Identifier and length are in range; bytes beyond the length, and all bytes of a remote frame, are
// zero.
constexpr bool IsValid(const Frame& frame) {
  if (frame.length > kMaxDataBytes) return false;
  if (frame.id > (frame.extended || frame.error ? kMaxExtendedId : kMaxStandardId)) return false;
  for (int i = frame.remote ? 0 : frame.length; i < kMaxDataBytes; ++i) {
    if (frame.data[static_cast<std::size_t>(i)] != 0) return false;
  }
  return true;
}

}  // namespace sinew::can
