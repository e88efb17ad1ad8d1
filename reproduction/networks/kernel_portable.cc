#include "reproduction/networks/kernel_body.h"

namespace sinew::networks::internal {

const Kernel<float> kPortableFloat = MakeKernel<float>();
const Kernel<double> kPortableDouble = MakeKernel<double>();

}  // namespace sinew::networks::internal
