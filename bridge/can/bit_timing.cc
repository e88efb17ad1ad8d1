#include "bridge/can/bit_timing.h"

namespace sinew::can {
namespace {

constexpr int kFixedBits = 13;  // CRC delimiter 1, acknowledge 2, end of frame 7, intermission 3
constexpr int kCrcBits = 15;
constexpr int kStuffCountBits = 4;
constexpr std::uint16_t kCrcPolynomial = 0x4599;

// 0 to 8 stand for themselves, 9 to 15 for 12, 16, 20, 24, 32, 48, 64.
std::uint32_t FdLengthCode(int length) {
  if (length <= 8) return static_cast<std::uint32_t>(length);
  if (length <= 24) return static_cast<std::uint32_t>(6 + length / 4);
  return length == 32 ? 13 : length == 48 ? 14 : 15;
}

// Calls sink(bit) for every bit from start of frame to the last data bit.
template <class Sink>
void ForEachBit(const Frame& frame, const Sink& sink) {
  const auto put = [&sink](std::uint32_t value, int bits) {
    for (int i = bits - 1; i >= 0; --i) sink((value >> i & 1U) != 0);
  };
  put(0, 1);  // start of frame
  if (frame.extended) {
    put(frame.id >> 18, 11);
    put(3, 2);  // SRR, IDE recessive
    put(frame.id & 0x3FFFF, 18);
    put(frame.remote ? 1 : 0, 1);
    if (!frame.fd) put(0, 2);  // r1, r0
  } else {
    put(frame.id, 11);
    put(frame.remote ? 1 : 0, 1);
    put(0, 1);                 // IDE
    if (!frame.fd) put(0, 1);  // r0
  }
  if (frame.fd) {
    put(2, 2);                              // FDF recessive, res
    put(frame.bit_rate_switch ? 2 : 0, 2);  // BRS, ESI (error active)
    put(FdLengthCode(frame.length), 4);
    for (int i = 0; i < frame.length; ++i) put(frame.data[static_cast<std::size_t>(i)], 8);
    return;
  }
  const int length = frame.length > kMaxDataBytes ? kMaxDataBytes : frame.length;
  put(static_cast<std::uint32_t>(length), 4);
  if (frame.remote) return;
  for (int i = 0; i < length; ++i) put(frame.data[static_cast<std::size_t>(i)], 8);
}

}  // namespace

std::uint16_t FrameCrc(const Frame& frame) noexcept {
  std::uint16_t crc = 0;
  ForEachBit(frame, [&crc](bool bit) {
    const bool next = bit != ((crc >> (kCrcBits - 1) & 1) != 0);
    crc = static_cast<std::uint16_t>(crc << 1 & 0x7FFF);
    if (next) crc ^= kCrcPolynomial;
  });
  return crc;
}

int FrameBits(const Frame& frame) noexcept {
  int bits = 0;
  int run = 0;
  bool last = true;  // the idle bus is recessive, but does not count into a run
  bool stuffed = false;
  const auto count = [&](bool bit) {
    ++bits;
    run = bit == last && run > 0 ? run + 1 : 1;
    last = bit;
    stuffed = run == 5;
    if (stuffed) {  // the stuff bit starts a run of its own
      ++bits;
      last = !bit;
      run = 1;
    }
  };
  ForEachBit(frame, count);
  if (frame.fd) {
    if (stuffed) --bits;  // the fixed stuff bit stands in its place
    const int guarded = kStuffCountBits + (frame.length <= 16 ? 17 : 21);
    return bits + guarded + (guarded + 3) / 4 + kFixedBits;
  }
  const std::uint16_t crc = FrameCrc(frame);
  for (int i = kCrcBits - 1; i >= 0; --i) count((crc >> i & 1) != 0);
  return bits + kFixedBits;
}

int WorstFrameBits(int length, bool extended) noexcept {
  const int stuffed = (extended ? 54 : 34) + 8 * length;
  return stuffed + (stuffed - 1) / 4 + kFixedBits;
}

std::uint32_t ArbitrationKey(const Frame& frame) noexcept {
  // 32 bits as they are sent: 11 of identifier, RTR or SRR, IDE, and 18 + RTR of extended frames.
  if (frame.extended) {
    return (frame.id >> 18) << 21 | 3U << 19 | (frame.id & 0x3FFFF) << 1 | (frame.remote ? 1U : 0U);
  }
  return frame.id << 21 | (frame.remote ? 1U << 20 : 0U);
}

}  // namespace sinew::can
