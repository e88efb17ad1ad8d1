// The outcome of an experiment on the standard output, as JSON, and as files.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tools/sinew/experiment_run.h"

namespace sinew::tools {

void PrintOutcome(const ExperimentOutcome& done);
nlohmann::ordered_json ToJson(const ExperimentOutcome& done);
// section.json with its pictures, data.csv, result.json. Throws UsageError.
void WriteFiles(const ExperimentOutcome& done, const std::filesystem::path& folder);

}  // namespace sinew::tools
