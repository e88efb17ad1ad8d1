#include "components/record/recording/file/run_reader.h"

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/recording_path.h"
#include "components/record/recording/file/ros_bag.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/run_builder.h"

namespace sinew::recording {

namespace {

std::vector<types::Run> ReadWhole(const RecordingPath& path, const std::filesystem::path& map,
                                  int joint) {
  const std::string name = path.file.string();
  if (IsRosBag(path.file)) {
    const RosTable table = ReadRosBag(path.file);
    return {
        ReadRun(table, name, map.empty() ? MapOfRosBag(table, path.file) : LoadCsvMap(map), joint)};
  }
  if (path.IsMcap()) {
    FileSource source(path.file);
    const McapReader reader(source);
    return RunsOfRecording(reader, name, joint);
  }
  if (map.empty()) {
    throw UsageError(name + ": no recording (.mcap), expected a mapping file to read it as CSV");
  }
  return {
      ReadCsvRun(config::ReadFile(path.file, config::kLargestData), name, LoadCsvMap(map), joint)};
}

}  // namespace

std::vector<types::Run> ReadRuns(const std::filesystem::path& path,
                                 const std::filesystem::path& map, int joint) {
  const RecordingPath given = ParseRecordingPath(path);
  try {
    std::vector<types::Run> runs = ReadWhole(given, map, joint);
    if (!given.range) return runs;
    std::vector<types::Run> cut;
    std::string nothing;
    for (const types::Run& run : runs) {
      try {
        cut.push_back(CutRun(run, *given.range));
      } catch (const std::invalid_argument& error) {
        nothing = error.what();
      }
    }
    if (cut.empty()) throw UsageError(nothing);
    return cut;
  } catch (const McapError& error) {
    throw UsageError(given.file.string() + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

BodyRun ReadBody(const std::filesystem::path& path) {
  const RecordingPath given = ParseRecordingPath(path);
  const std::string name = given.file.string();
  if (!given.IsMcap()) {
    throw UsageError(name + ": no recording (.mcap), expected one with foot_force and imu");
  }
  try {
    FileSource source(given.file);
    const McapReader reader(source);
    return BodyOfRecording(reader, name);
  } catch (const McapError& error) {
    throw UsageError(name + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sinew::recording
