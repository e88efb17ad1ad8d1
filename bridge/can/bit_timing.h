// The time that a frame takes on the wire. Pure; any thread; allocates nothing.
//
// ISO 11898-1: start bit, arbitration, control, data and CRC field are stuffed (after five equal
// bits one of the opposite value, which counts in turn); CRC delimiter, acknowledge (2), end of
// frame (7) and intermission (3) are not. CRC-15 generator 0x4599. Standard frames: 34 + 8 n
// stuffed bits, 13 fixed; extended ones: 54 + 8 n.
//
// FD frames (ISO 11898-1:2015): from the start to the data stuffed as above; then stuff count (4)
// and CRC (17 bits up to 16 bytes, 21 beyond) with a fixed stuff bit in front and after every four
// bits; the same 13 bits behind.
#pragma once

#include <cstdint>

#include "bridge/can/frame.h"

namespace sinew::can {

// Bits from start of frame to the end of the intermission, stuff bits of exactly this content
// included. Of an FD frame with bit_rate_switch most of them are sent at the data rate.
int FrameBits(const Frame& frame) noexcept;

// The same for the worst content of this length: a stuff bit after the first five bits and every
// four more.
int WorstFrameBits(int length, bool extended = false) noexcept;

// Error flag (6..12), delimiter (8) and intermission (3), with the longest superposition.
inline constexpr int kErrorFrameBits = 23;

// Sort key of arbitration: the smaller one wins (dominant bits are 0; a data frame wins over a
// remote frame, a standard one over an extended one with the same first 11 bits).
std::uint32_t ArbitrationKey(const Frame& frame) noexcept;

}  // namespace sinew::can
