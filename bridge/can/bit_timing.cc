#include "bridge/can/bit_timing.h"

#include <algorithm>
#include <array>

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

// Bits of the frame from its start to the length code, the last one lowest.
struct HeaderBits {
  std::uint64_t bits = 0;
  int count = 0;
  void Put(std::uint32_t value, int width) {
    bits = bits << width | value;
    count += width;
  }
};

HeaderBits HeaderOf(const Frame& frame) {
  HeaderBits header;
  header.Put(0, 1);  // start of frame
  if (frame.extended) {
    header.Put(frame.id >> 18 & 0x7FF, 11);
    header.Put(3, 2);  // SRR, IDE recessive
    header.Put(frame.id & 0x3FFFF, 18);
    header.Put(frame.remote ? 1 : 0, 1);
    if (!frame.fd) header.Put(0, 2);  // r1, r0
  } else {
    header.Put(frame.id & kMaxStandardId, 11);
    header.Put(frame.remote ? 1 : 0, 1);
    header.Put(0, 1);                 // IDE
    if (!frame.fd) header.Put(0, 1);  // r0
  }
  if (frame.fd) {
    header.Put(2, 2);                              // FDF recessive, res
    header.Put(frame.bit_rate_switch ? 2 : 0, 2);  // BRS, ESI (error active)
    header.Put(FdLengthCode(frame.length), 4);
  } else {
    header.Put(std::min<std::uint32_t>(frame.length, kMaxDataBytes), 4);
  }
  return header;
}

int DataBytes(const Frame& frame) {
  if (frame.fd) return frame.length;
  return frame.remote ? 0 : std::min<int>(frame.length, kMaxDataBytes);
}

constexpr std::uint16_t CrcStep(std::uint16_t crc, bool bit) {
  const bool next = bit != ((crc >> (kCrcBits - 1) & 1) != 0);
  crc = static_cast<std::uint16_t>(crc << 1 & 0x7FFF);
  return next ? crc ^ kCrcPolynomial : crc;
}

// The change of a CRC by eight bits, by its upper eight bits and theirs.
constexpr auto kCrcOfByte = [] {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    for (int i = 7; i >= 0; --i) table[byte] = CrcStep(table[byte], (byte >> i & 1) != 0);
  }
  return table;
}();

std::uint16_t CrcBytes(std::uint16_t crc, std::uint8_t byte) {
  return static_cast<std::uint16_t>((crc << 8 & 0x7FFF) ^ kCrcOfByte[(crc >> 7 ^ byte) & 0xFF]);
}

// CRC of the bits in front of it, unstuffed.
std::uint16_t CrcOf(const Frame& frame, const HeaderBits& header) {
  std::uint16_t crc = 0;
  // Dominant bits in front of the first change nothing.
  for (int shift = (header.count + 7) / 8 * 8 - 8; shift >= 0; shift -= 8) {
    crc = CrcBytes(crc, static_cast<std::uint8_t>(header.bits >> shift));
  }
  for (int i = 0; i < DataBytes(frame); ++i) {
    crc = CrcBytes(crc, frame.data[static_cast<std::size_t>(i)]);
  }
  return crc;
}

// Counts stuff bits: a run of five equal bits is followed by one of the opposite value, which
// starts a run of its own. State: (run - 1) * 2 + value of the last bit, or kStuffed + value of the
// stuff bit that was the last.
class Stuffing {
 public:
  int stuff_bits() const { return stuff_bits_; }
  bool ended_stuffed() const { return state_ >= kStuffed; }

  // The lowest `count` of `bits`, the highest of them first.
  void Put(std::uint64_t bits, int count) {
    while (count % 8 != 0) {
      const Step step = Next(state_, (bits >> --count & 1) != 0);
      state_ = step.state;
      stuff_bits_ += step.stuff_bits;
    }
    while (count > 0) {
      count -= 8;
      const Step step = kOfByte[state_][bits >> count & 0xFF];
      state_ = step.state;
      stuff_bits_ += step.stuff_bits;
    }
  }

 private:
  static constexpr std::uint8_t kStuffed = 8, kStart = 10, kStates = 11;
  struct Step {
    std::uint8_t state = kStart;
    std::uint8_t stuff_bits = 0;
  };
  static constexpr Step Next(std::uint8_t state, bool bit) {
    // The idle bus is recessive, but does not count into a run.
    const bool last = (state & 1) != 0;
    const int before = state == kStart ? 0 : state >= kStuffed ? 1 : state / 2 + 1;
    const int run = before > 0 && bit == last ? before + 1 : 1;
    if (run == 5) return {static_cast<std::uint8_t>(kStuffed + (bit ? 0 : 1)), 1};
    return {static_cast<std::uint8_t>((run - 1) * 2 + (bit ? 1 : 0)), 0};
  }
  static const std::array<std::array<Step, 256>, kStates> kOfByte;

  std::uint8_t state_ = kStart;
  int stuff_bits_ = 0;
};

constexpr std::array<std::array<Stuffing::Step, 256>, Stuffing::kStates> Stuffing::kOfByte = [] {
  std::array<std::array<Step, 256>, kStates> table{};
  for (std::uint8_t state = 0; state < kStates; ++state) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      Step sum{state, 0};
      for (int i = 7; i >= 0; --i) {
        const Step step = Next(sum.state, (byte >> i & 1) != 0);
        sum = {step.state, static_cast<std::uint8_t>(sum.stuff_bits + step.stuff_bits)};
      }
      table[state][byte] = sum;
    }
  }
  return table;
}();

}  // namespace

int FrameBits(const Frame& frame) noexcept {
  const HeaderBits header = HeaderOf(frame);
  const int bytes = DataBytes(frame);
  Stuffing stuffing;
  stuffing.Put(header.bits, header.count);
  for (int i = 0; i < bytes; ++i) stuffing.Put(frame.data[static_cast<std::size_t>(i)], 8);
  const int bits = header.count + 8 * bytes;
  if (frame.fd) {
    const int guarded = kStuffCountBits + (frame.length <= 16 ? 17 : 21);
    // A stuff bit at the very end is replaced by the fixed one.
    const int stuffed = stuffing.stuff_bits() - (stuffing.ended_stuffed() ? 1 : 0);
    return bits + stuffed + guarded + (guarded + 3) / 4 + kFixedBits;
  }
  stuffing.Put(CrcOf(frame, header), kCrcBits);
  return bits + kCrcBits + stuffing.stuff_bits() + kFixedBits;
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
