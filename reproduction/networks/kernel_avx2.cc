#include "reproduction/networks/kernel_body.h"

namespace sinew::networks::internal {

const Kernel<float> kAvx2Float = MakeKernel<float>();
const Kernel<double> kAvx2Double = MakeKernel<double>();

}  // namespace sinew::networks::internal
