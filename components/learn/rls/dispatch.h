// From the instruction set to its kernel, and which set is the fastest. Private to this module.
#pragma once

#include "components/base/simd/instructions.h"
#include "components/learn/rls/kernel.h"

namespace sinew::rls::internal {

const Kernel& KernelFor(simd::Instructions instructions) noexcept;

// The fastest set on this machine for an update. The first call measures for less than a
// millisecond (simd/fastest.h) and allocates; later ones return what it found. Any thread.
simd::Instructions FastestUpdate();

}  // namespace sinew::rls::internal
