// What the control test found, as a section of a page of results: published beside ours, the table
// of pressures and loads, the pictures. Pure text.
#pragma once

#include <vector>

#include "components/model/report/section.h"
#include "reproduction/control_test/runner.h"

namespace sinew::control_test {

// benchmark: at least one run of each of the arms PID, linear, network, inverse. grid: may be
// empty. Throws std::invalid_argument when an arm is missing.
report::Section MakeSection(const std::vector<Outcome>& benchmark,
                            const std::vector<Outcome>& grid);

// Mean over the seeds of an arm, rad^2.
double MeanMse(const std::vector<Outcome>& outcomes, Arm arm);

}  // namespace sinew::control_test
