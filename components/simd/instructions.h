// Which instruction set the inner loops of the learning modules use on this machine.
#pragma once

namespace sinew::simd {

enum class Instructions { kPortable, kAvx2, kAvx512 };

// The widest set that was compiled in and that this processor and its operating system run.
Instructions BestInstructions() noexcept;

// True when a loop compiled for this set may be called here.
bool Runs(Instructions instructions) noexcept;

const char* Name(Instructions instructions) noexcept;

}  // namespace sinew::simd
