// Pieces of the sections of results that all of these tables have.
#pragma once

#include <optional>
#include <string>

#include "components/model/report/section.h"

namespace sinew::reproduction {

// Adds one figure beside its target. met: nothing where there is no target.
void Compare(report::Section* section, std::string name, std::string unit, std::string ours,
             std::string target, std::optional<bool> met, std::string remark = "");

}  // namespace sinew::reproduction
