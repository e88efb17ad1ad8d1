#include "reproduction/networks/kernel_body.h"

namespace sinew::networks::internal {

const Kernel<float> kAvx512Float = MakeKernel<float>();
const Kernel<double> kAvx512Double = MakeKernel<double>();

}  // namespace sinew::networks::internal
