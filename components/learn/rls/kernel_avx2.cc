#include "components/learn/rls/kernel_body.h"

namespace sinew::rls::internal {

const Kernel kAvx2Kernel = {Project, Update, Dot, AddScaled};

}  // namespace sinew::rls::internal
