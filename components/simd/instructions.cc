#include "components/simd/instructions.h"

#include <initializer_list>

namespace sinew::simd {

bool Runs(Instructions instructions) noexcept {
  switch (instructions) {
    case Instructions::kPortable:
      return true;
#if defined(__x86_64__)
    case Instructions::kAvx2:
      return __builtin_cpu_supports("avx2") != 0;
    case Instructions::kAvx512:
      return __builtin_cpu_supports("avx512f") != 0;
#endif
    default:
      return false;
  }
}

Instructions BestInstructions() noexcept {
  for (const Instructions set : {Instructions::kAvx512, Instructions::kAvx2}) {
    if (Runs(set)) return set;
  }
  return Instructions::kPortable;
}

const char* Name(Instructions instructions) noexcept {
  switch (instructions) {
    case Instructions::kAvx2:
      return "AVX2";
    case Instructions::kAvx512:
      return "AVX-512";
    default:
      return "portable";
  }
}

}  // namespace sinew::simd
