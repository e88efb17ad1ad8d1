#include "components/record/recording/file/import.h"

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"

namespace sinew::recording {
namespace {

void Check(const IoStatus& status, const std::filesystem::path& out) {
  if (!status.ok()) throw UsageError(out.string() + ": cannot be written: " + status.message());
}

}  // namespace

ImportResult ImportCsv(const std::vector<std::filesystem::path>& csv_paths,
                       const std::filesystem::path& map, const std::filesystem::path& out,
                       const FindSchema& find_schema,
                       const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  const CsvMap csv_map = LoadCsvMap(map);
  ImportResult result;
  std::vector<types::Run> runs;
  try {
    for (const std::filesystem::path& path : csv_paths) {
      runs.push_back(
          ReadCsvRun(config::ReadFile(path, config::kLargestData), path.string(), csv_map));
      result.samples += static_cast<std::uint64_t>(runs.back().size());
    }
    WholeFileSink sink(out);
    McapWriter writer(sink);
    Check(writer.Open(), out);
    std::uint64_t done = 0;
    for (const types::Run& run : runs) {
      Check(writer.WriteMetadata({"sinew.import",
                                  {{"csv", std::filesystem::path(run.name).filename().string()},
                                   {"mapping", map.filename().string()},
                                   {"content_hash", run.content_hash},
                                   {"samples", std::to_string(run.size())}}}),
            out);
    }
    RunImporter importer(find_schema, writer);
    for (const types::Run& run : runs) {
      Check(importer.Add(run,
                         [&](Eigen::Index row) {
                           if (progress)
                             progress(done + static_cast<std::uint64_t>(row), result.samples);
                         }),
            out);
      done += static_cast<std::uint64_t>(run.size());
    }
    Check(writer.Close(), out);
    Check(sink.Commit(), out);
    result.runs = runs.size();
    result.messages = writer.statistics().message_count;
    result.bytes = writer.bytes_written();
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return result;
}

}  // namespace sinew::recording
