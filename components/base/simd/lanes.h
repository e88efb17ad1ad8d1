// Eight doubles side by side, in as few registers as the instruction set of this source file
// allows.
//
// Include only from a kernel_*.cc; such a file includes nothing of the standard library but
// <cstdint>, so that no inline function compiled for a wide instruction set can replace its
// ordinary twin at link time. No operation is fused (kernels are compiled with -ffp-contract=off)
// and Sum() has a fixed order: the result does not depend on the instruction set.
#pragma once

#include <cstdint>

namespace {

#if defined(__AVX512F__)
constexpr int kPackBytes = 64;
#elif defined(__AVX2__)
constexpr int kPackBytes = 32;
#else
constexpr int kPackBytes = 16;
#endif
constexpr int kLanes = 8;
constexpr int kPackLanes = kPackBytes / 8;
constexpr int kPacks = kLanes / kPackLanes;

typedef double Pack __attribute__((vector_size(kPackBytes)));
typedef std::int64_t PackBits __attribute__((vector_size(kPackBytes)));
typedef double UnalignedPack __attribute__((vector_size(kPackBytes), aligned(8)));

#define SINEW_LANES_INLINE inline __attribute__((always_inline))

struct Lanes {
  Pack pack[kPacks];
};

SINEW_LANES_INLINE Lanes Broadcast(double value) {
  Lanes result;
  for (int p = 0; p < kPacks; ++p) result.pack[p] = value - Pack{};
  return result;
}

SINEW_LANES_INLINE Lanes Load(const double* from) {
  Lanes result;
  for (int p = 0; p < kPacks; ++p) {
    result.pack[p] = *reinterpret_cast<const UnalignedPack*>(from + p * kPackLanes);
  }
  return result;
}

SINEW_LANES_INLINE void Store(double* to, const Lanes& a) {
  for (int p = 0; p < kPacks; ++p) {
    *reinterpret_cast<UnalignedPack*>(to + p * kPackLanes) = a.pack[p];
  }
}

// from[index[0]] .. from[index[7]], by plain loads: gather instructions are slower than the loads
// that they replace on the processors measured (docs/decisions/0011-vector-kernels.md). Two indices
// are read at a time and split in a register, because loads are what limits the speed.
SINEW_LANES_INLINE Lanes Gather(const double* from, const std::int32_t* index) {
  typedef double Pair __attribute__((vector_size(16)));
  Pair pair[kLanes / 2];
  for (int p = 0; p < kLanes / 2; ++p) {
    std::uint64_t two;
    __builtin_memcpy(&two, index + 2 * p, sizeof two);
    asm("" : "+r"(two));  // in an integer register: GCC would read it into a vector register
    pair[p] = Pair{from[two & 0xffffffffU], from[two >> 32]};
  }
  Lanes result;
#if defined(__AVX512F__)
  result.pack[0] = __builtin_shufflevector(__builtin_shufflevector(pair[0], pair[1], 0, 1, 2, 3),
                                           __builtin_shufflevector(pair[2], pair[3], 0, 1, 2, 3), 0,
                                           1, 2, 3, 4, 5, 6, 7);
#elif defined(__AVX2__)
  for (int p = 0; p < kPacks; ++p) {
    result.pack[p] = __builtin_shufflevector(pair[2 * p], pair[2 * p + 1], 0, 1, 2, 3);
  }
#else
  for (int p = 0; p < kPacks; ++p) result.pack[p] = pair[p];
#endif
  return result;
}

// from[index[0]] four times, then from[index[1]] four times.
SINEW_LANES_INLINE Lanes Spread(const double* from, const std::int32_t* index) {
  Lanes result;
#if defined(__AVX512F__)
  typedef double Four __attribute__((vector_size(32)));
  const Four low = from[index[0]] - Four{};
  const Four high = from[index[1]] - Four{};
  result.pack[0] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  for (int p = 0; p < kPacks; ++p) result.pack[p] = from[index[p * kPackLanes / 4]] - Pack{};
#endif
  return result;
}

#define SINEW_LANES_OPERATOR(op)                                              \
  SINEW_LANES_INLINE Lanes operator op(const Lanes& a, const Lanes& b) {      \
    Lanes result;                                                             \
    for (int p = 0; p < kPacks; ++p) result.pack[p] = a.pack[p] op b.pack[p]; \
    return result;                                                            \
  }
SINEW_LANES_OPERATOR(+)
SINEW_LANES_OPERATOR(-)
SINEW_LANES_OPERATOR(*)
SINEW_LANES_OPERATOR(/)
#undef SINEW_LANES_OPERATOR

// a < b ? a : b, so b where either is not a number.
SINEW_LANES_INLINE Lanes Min(const Lanes& a, const Lanes& b) {
  Lanes result;
  for (int p = 0; p < kPacks; ++p) result.pack[p] = a.pack[p] < b.pack[p] ? a.pack[p] : b.pack[p];
  return result;
}

SINEW_LANES_INLINE Lanes Abs(const Lanes& a) {
  Lanes result;
  for (int p = 0; p < kPacks; ++p) {
    result.pack[p] = reinterpret_cast<Pack>(reinterpret_cast<PackBits>(a.pack[p]) & INT64_MAX);
  }
  return result;
}

// magnitude (which must be positive) with the sign of a.
SINEW_LANES_INLINE Lanes WithSignOf(const Lanes& magnitude, const Lanes& a) {
  Lanes result;
  for (int p = 0; p < kPacks; ++p) {
    result.pack[p] = reinterpret_cast<Pack>(reinterpret_cast<PackBits>(magnitude.pack[p]) |
                                            (reinterpret_cast<PackBits>(a.pack[p]) & INT64_MIN));
  }
  return result;
}

// 2^n for shifted = n + kShift, |n| < 1000: the low bits of the sum are n.
constexpr double kShift = 0x1.8p52;
SINEW_LANES_INLINE Lanes PowerOfTwo(const Lanes& shifted) {
  Lanes result;
  for (int p = 0; p < kPacks; ++p) {
    const PackBits n = reinterpret_cast<PackBits>(shifted.pack[p]);
    result.pack[p] = reinterpret_cast<Pack>((n << 52) + (std::int64_t{1023} << 52));
  }
  return result;
}

// The sum of the eight, pairwise: the same order for every instruction set.
SINEW_LANES_INLINE double Sum(const Lanes& a) {
  double v[kLanes];
  Store(v, a);
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

}  // namespace
