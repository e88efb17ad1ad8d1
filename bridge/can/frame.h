// A CAN frame, as every codec, transport and test of this project passes it on.
//
// Plain data: 11-bit or 29-bit identifier, up to 8 bytes; CAN FD frames up to 64. The controllers
// we drive are classic ones: no codec makes FD frames, SocketCAN and logs carry them, the modelled
// buses are classic and refuse them.
#pragma once

#include <array>
#include <cstdint>

namespace sinew::can {

inline constexpr int kMaxDataBytes = 8;  // of a classic frame
inline constexpr int kMaxFdDataBytes = 64;
inline constexpr std::uint32_t kMaxStandardId = 0x7FF;
inline constexpr std::uint32_t kMaxExtendedId = 0x1FFFFFFF;

struct Frame {
  std::uint32_t id = 0;
  bool extended = false;  // 29-bit identifier
  bool remote = false;    // asks for data; carries none, length is that of the data asked for
  bool error = false;     // not from the bus: a controller's report, id holds the error class bits
  bool fd = false;        // ISO 11898-1:2015; no remote frames
  bool bit_rate_switch = false;  // of an FD frame: its data at the higher rate
  std::uint8_t length = 0;
  std::array<std::uint8_t, kMaxFdDataBytes> data{};

  friend bool operator==(const Frame&, const Frame&) = default;
};

// Lengths that an FD frame can have: 0 to 8, 12, 16, 20, 24, 32, 48, 64.
constexpr bool IsFdLength(int length) {
  return length >= 0 && (length <= 8 || (length <= 24 && length % 4 == 0) || length == 32 ||
                         length == 48 || length == 64);
}

// Identifier and length are in range; bytes beyond the length, and all bytes of a remote frame, are
// zero.
constexpr bool IsValid(const Frame& frame) {
  if (frame.fd ? !IsFdLength(frame.length) : frame.length > kMaxDataBytes) return false;
  if (frame.fd ? frame.remote || frame.error : frame.bit_rate_switch) return false;
  if (frame.id > (frame.extended || frame.error ? kMaxExtendedId : kMaxStandardId)) return false;
  for (int i = frame.remote ? 0 : frame.length; i < kMaxFdDataBytes; ++i) {
    if (frame.data[static_cast<std::size_t>(i)] != 0) return false;
  }
  return true;
}

}  // namespace sinew::can
