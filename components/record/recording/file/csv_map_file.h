// Mapping files (schema sinew-csv-map/1), see docs/formats.md.
#pragma once

#include <filesystem>
#include <string>

#include "components/base/config/fields.h"
#include "components/record/recording/csv_map.h"

namespace sinew::recording {

inline constexpr char kSchema[] = "sinew-csv-map/1";

void Describe(config::Fields& f, CsvMap& c);

// Throws UsageError with file, line, key and what was expected.
CsvMap LoadCsvMap(const std::filesystem::path& path);
CsvMap ParseCsvMap(const std::string& text, const std::string& name);

}  // namespace sinew::recording
