// Recordings as all reports list them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "components/model/report/report.h"

namespace sinew::report {

// name, content_hash, rows, duration_s of each.
nlohmann::ordered_json RecordingsJson(const std::vector<Recording>& recordings);

}  // namespace sinew::report
