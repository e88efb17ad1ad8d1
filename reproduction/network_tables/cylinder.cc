#include "reproduction/network_tables/cylinder.h"

#include <algorithm>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"

namespace sinew::reproduction {
namespace {

constexpr const char* kMap =
    "schema: sinew-csv-map/1\n"
    "kind: linear\n"
    "time: {column: time_s, unit: s}\n"
    "signals:\n"
    "  position: {column: x_mm, unit: mm}\n"
    "  chamber_pressure: {column: p_bar, unit: bar}\n"
    "  load_force: {column: F_N, unit: N}\n";
constexpr Eigen::Index kStartUpRows = 15;

}  // namespace

std::vector<types::Run> ReadCylinder(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  if (error || files.empty()) {
    throw UsageError(folder.string() +
                     ": no CSV files there, expected recordings with time_s, x_mm, p_bar, F_N");
  }
  std::sort(files.begin(), files.end());
  const recording::CsvMap map = recording::ParseCsvMap(kMap, "columns of the cylinder");
  std::vector<types::Run> runs;
  for (const std::filesystem::path& file : files) {
    try {
      types::Run run = recording::ReadCsvRun(config::ReadFile(file, config::kLargestData),
                                             file.filename().string(), map);
      const Eigen::Index left = run.size() - kStartUpRows;
      if (left < 1) continue;
      run.time_s = run.time_s.tail(left).eval();
      for (auto& [signal, column] : run.signals) column = column.tail(left).eval();
      runs.push_back(std::move(run));
    } catch (const std::invalid_argument& bad) {
      throw UsageError(bad.what());
    }
  }
  return runs;
}

}  // namespace sinew::reproduction
