#include "components/learn/esn/kernel_body.h"

namespace sinew::esn::internal {

const Kernel kAvx2Kernel = {Step<false>, Step<true>, TanhInPlace, Gram};

}  // namespace sinew::esn::internal
