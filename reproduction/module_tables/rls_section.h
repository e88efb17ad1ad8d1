// Recursive least squares against batch, in a soak, and timed, as a section of a page.
#pragma once

#include <vector>

#include "bench/acceptance/rls.h"
#include "components/model/report/section.h"

namespace sinew::reproduction {

report::Section MakeRlsSection(const acceptance::BatchScore& batch,
                               const acceptance::SoakScore& soak,
                               const std::vector<acceptance::TimeScore>& times);

}  // namespace sinew::reproduction
