#include "components/learn/rls/kernel_body.h"

namespace sinew::rls::internal {

const Kernel kPortableKernel = {Project, Update, Dot, AddScaled};

}  // namespace sinew::rls::internal
