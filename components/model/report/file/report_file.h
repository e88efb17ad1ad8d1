// The report as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "components/model/report/file/section_file.h"
#include "components/model/report/gate_page.h"
#include "components/model/report/report.h"

namespace sinew::report {

// report.json; keys are documented in docs/formats.md.
std::string FormatJson(const Report& report);

// check.json of `sinew check-data`; and report.json of a close-loop that stopped at the data gate:
// the same keys, with nothing found.
std::string FormatCheckJson(const DataCheck& check);
std::string FormatDataFaultJson(const DataCheck& check);
// report.json where the recordings have too little data (TraceResult::too_little).
std::string FormatTooLittleJson(const Report& report);
nlohmann::ordered_json FaultsJson(const std::vector<gate::Fault>& faults);

}  // namespace sinew::report
