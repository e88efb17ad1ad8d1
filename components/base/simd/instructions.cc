#include "components/base/simd/instructions.h"

#include <stdexcept>
#include <string>

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

void RequireRuns(Instructions instructions) {
  if (Runs(instructions)) return;
  throw std::invalid_argument(std::string("instructions: ") + Name(instructions) +
                              " does not run on this machine");
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
