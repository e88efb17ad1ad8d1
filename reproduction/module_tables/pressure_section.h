// The pressure manager on the surrogate's air supply as a section of a page.
#pragma once

#include "bench/acceptance/pressure.h"
#include "components/model/report/section.h"

namespace sinew::reproduction {

report::Section MakePressureSection(const acceptance::PressureCheck& check,
                                    const pneumatics::ManagerConfig& config);

}  // namespace sinew::reproduction
