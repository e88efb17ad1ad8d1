// The instruction sets that inner loops are compiled for, and which of them run on this machine.
// Any thread; no memory is taken.
#pragma once

#include <array>

namespace sinew::simd {

enum class Instructions { kPortable, kAvx2, kAvx512 };

inline constexpr std::array kAllInstructions = {Instructions::kPortable, Instructions::kAvx2,
                                                Instructions::kAvx512};

// True when a loop compiled for this set may be called here: it was compiled in, and the processor
// and its operating system support it.
bool Runs(Instructions instructions) noexcept;

// Throws std::invalid_argument with the set's name when it does not run here.
void RequireRuns(Instructions instructions);

const char* Name(Instructions instructions) noexcept;

}  // namespace sinew::simd
