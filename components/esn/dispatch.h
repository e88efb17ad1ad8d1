// From the instruction set to its kernel. Private to this module.
#pragma once

#include "components/esn/kernel.h"
#include "components/simd/instructions.h"

namespace sinew::esn::internal {

const Kernel& KernelFor(simd::Instructions instructions) noexcept;

// The next multiple of block.
int Padded(int count, int block) noexcept;

}  // namespace sinew::esn::internal
