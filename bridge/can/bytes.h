// Little-endian fields of a frame: what both codecs build on. Bounds are the caller's: each
// message's length is checked once, before its fields are read.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "bridge/can/frame.h"

namespace sinew::can {

template <class Integer>
void PutInteger(Frame& frame, int byte, Integer value) {
  const auto bits = static_cast<std::make_unsigned_t<Integer>>(value);
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    frame.data[static_cast<std::size_t>(byte) + i] = static_cast<std::uint8_t>(bits >> (8 * i));
  }
}

template <class Integer>
Integer GetInteger(const Frame& frame, int byte) {
  std::make_unsigned_t<Integer> bits = 0;
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    bits = static_cast<std::make_unsigned_t<Integer>>(
        bits |
        (static_cast<std::make_unsigned_t<Integer>>(frame.data[static_cast<std::size_t>(byte) + i])
         << (8 * i)));
  }
  return static_cast<Integer>(bits);
}

inline void PutFloat(Frame& frame, int byte, double value) {
  static_assert(sizeof(float) == 4 && std::numeric_limits<float>::is_iec559);
  PutInteger(frame, byte, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

inline double GetFloat(const Frame& frame, int byte) {
  return static_cast<double>(std::bit_cast<float>(GetInteger<std::uint32_t>(frame, byte)));
}

// value / unit, rounded to the nearest integer of the field and held at its ends. NaN becomes 0.
template <class Integer>
Integer Quantise(double value, double unit) {
  if (std::isnan(value)) return 0;
  const double scaled = std::nearbyint(value / unit);
  if (scaled <= static_cast<double>(std::numeric_limits<Integer>::min())) {
    return std::numeric_limits<Integer>::min();
  }
  if (scaled >= static_cast<double>(std::numeric_limits<Integer>::max())) {
    return std::numeric_limits<Integer>::max();
  }
  return static_cast<Integer>(scaled);
}

}  // namespace sinew::can
