#include "components/recording/file/run_reader.h"

#include "components/config/config.h"
#include "components/recording/csv_map.h"
#include "components/recording/file/csv_map_file.h"
#include "components/recording/file/file_io.h"
#include "components/recording/mcap_reader.h"
#include "components/recording/run_builder.h"

namespace sinew::recording {

std::vector<identify::Run> ReadRuns(const std::filesystem::path& path,
                                    const std::filesystem::path& map, int joint) {
  try {
    if (path.extension() == ".mcap") {
      FileSource source(path);
      const McapReader reader(source);
      return RunsOfRecording(reader, path.string(), joint);
    }
    if (map.empty()) {
      throw UsageError(path.string() +
                       ": no recording (.mcap), expected a mapping file to read it as CSV");
    }
    return {ReadCsvRun(config::ReadFile(path), path.string(), LoadCsvMap(map), joint)};
  } catch (const McapError& error) {
    throw UsageError(path.string() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sinew::recording
