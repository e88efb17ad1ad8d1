// The regime detector on the surrogate as a section of a page (Fig 7.1).
#pragma once

#include "bench/acceptance/regime.h"
#include "components/model/report/section.h"

namespace sinew::reproduction {

report::Section MakeRegimeSection(const acceptance::RegimeGrid& grid);

}  // namespace sinew::reproduction
