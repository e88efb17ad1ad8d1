// From the instruction set to its kernel, and which set is the fastest. Private to this module.
#pragma once

#include <type_traits>

#include "components/base/simd/instructions.h"
#include "reproduction/networks/kernel.h"

namespace sinew::networks::internal {

template <typename S>
const Kernel<S>& KernelFor(simd::Instructions instructions) noexcept {
  (void)instructions;
  if constexpr (std::is_same_v<S, float>) {
#if defined(__x86_64__)
    if (instructions == simd::Instructions::kAvx512) return kAvx512Float;
    if (instructions == simd::Instructions::kAvx2) return kAvx2Float;
#endif
    return kPortableFloat;
  } else {
#if defined(__x86_64__)
    if (instructions == simd::Instructions::kAvx512) return kAvx512Double;
    if (instructions == simd::Instructions::kAvx2) return kAvx2Double;
#endif
    return kPortableDouble;
  }
}

// The fastest set on this machine for tiles of samples (S: float or double), and for one sample at
// a time. The first call measures for about a millisecond (simd/fastest.h) and allocates; later
// ones return what it found. Any thread.
template <typename S>
simd::Instructions FastestTraining();
simd::Instructions FastestSample();

}  // namespace sinew::networks::internal
