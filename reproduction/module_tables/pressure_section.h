// The pressure manager on the surrogate's air supply as a section of a page.
#pragma once

#include "components/report/section.h"
#include "tools/acceptance/pressure.h"

namespace sinew::reproduction {

report::Section MakePressureSection(const acceptance::PressureCheck& check,
                                    const pneumatics::ManagerConfig& config);

}  // namespace sinew::reproduction
