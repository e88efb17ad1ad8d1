// Results of close-loop as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "components/model/report/report.h"
#include "components/model/report/stance_page.h"

namespace sinew::report {

// report.json; keys are documented in docs/formats.md. Where nothing was traced, because the data
// gate stopped or the recordings have too little data, what was found is empty.
nlohmann::ordered_json ReportJson(const Report& report);
nlohmann::ordered_json ReportJson(const StanceReport& report);
// check.json of `sinew check-data`.
nlohmann::ordered_json CheckJson(const Report& report);

// Parts of them: name, content_hash, rows, duration_s of each; name and probability of each.
nlohmann::ordered_json RecordingsJson(const std::vector<Recording>& recordings);
nlohmann::ordered_json PosteriorJson(const trace::Posterior& posterior);

}  // namespace sinew::report
