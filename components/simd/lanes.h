// Eight doubles side by side, in as few registers as the instruction set of this source file
// allows.
//
// Include only from a kernel_*.cc; such a file includes nothing of the standard library but
// <cstdint>, so that no inline function compiled for a wide instruction set can replace its
// ordinary twin at link time. No operation is fused (kernels are compiled with -ffp-contract=off)
// and Sum() has a fixed order: the result does not depend on the instruction set.
#pragma once

#include <cstdint>
#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

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

// from[index[0]] .. from[index[7]]. The masked forms: the plain ones read an undefined register,
// which GCC 12 warns about.
SINEW_LANES_INLINE Lanes Gather(const double* from, const std::int32_t* index) {
  Lanes result;
#if defined(__AVX512F__)
  const __m256i i = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(index));
  result.pack[0] = reinterpret_cast<Pack>(
      _mm512_mask_i32gather_pd(_mm512_setzero_pd(), static_cast<__mmask8>(0xff), i, from, 8));
#elif defined(__AVX2__)
  for (int p = 0; p < kPacks; ++p) {
    const __m128i i = _mm_loadu_si128(reinterpret_cast<const __m128i*>(index + p * kPackLanes));
    const __m256d all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
    result.pack[p] =
        reinterpret_cast<Pack>(_mm256_mask_i32gather_pd(_mm256_setzero_pd(), from, i, all, 8));
  }
#else
  for (int p = 0; p < kPacks; ++p) {
    for (int l = 0; l < kPackLanes; ++l) result.pack[p][l] = from[index[p * kPackLanes + l]];
  }
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
