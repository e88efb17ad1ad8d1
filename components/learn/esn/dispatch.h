// From the instruction set to its kernel, and which set is the fastest. Private to this module.
#pragma once

#include "components/base/simd/instructions.h"
#include "components/learn/esn/kernel.h"

namespace sinew::esn::internal {

const Kernel& KernelFor(simd::Instructions instructions) noexcept;

// The fastest set on this machine for a step, and for sums of products. The first call measures for
// less than a millisecond (simd/fastest.h) and allocates; later ones return what it found. Any
// thread.
simd::Instructions FastestStep();
simd::Instructions FastestSharedStep();
simd::Instructions FastestGram();

// The next multiple of block.
int Padded(int count, int block) noexcept;

}  // namespace sinew::esn::internal
