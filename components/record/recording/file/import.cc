#include "components/record/recording/file/import.h"

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/ros_bag.h"
#include "components/record/recording/mcap_writer.h"

namespace sinew::recording {
namespace {

void Check(const IoStatus& status, const std::filesystem::path& out) {
  if (!status.ok()) throw UsageError(out.string() + ": cannot be written: " + status.message());
}

using Session = std::vector<types::Run>;  // of each joint

Session ReadJoints(const TableSource& table, const std::string& name, const CsvMap& map) {
  Session session;
  for (int joint = 0; joint < map.joints; ++joint) {
    session.push_back(ReadRun(table, name, map, joint));
  }
  return session;
}

Session ReadFile(const std::filesystem::path& path, const std::filesystem::path& map,
                 std::vector<std::string>* notes) {
  const std::string name = path.string();
  if (!IsRosBag(path)) {
    const std::string text = config::ReadFile(path, config::kLargestData);
    if (map.empty()) throw UsageError(name + ": a CSV file needs a mapping, expected --map");
    const CsvMap csv_map = LoadCsvMap(map);
    return ReadJoints(CsvText(text, name, csv_map.format), name, csv_map);
  }
  const RosTable table = ReadRosBag(path, notes);
  const CsvMap bag_map = map.empty() ? MapOfRosBag(table, path) : LoadCsvMap(map);
  Session session = ReadJoints(table, name, bag_map);
  const std::size_t messages = table.MessagesOf(bag_map.time.sum.at(0).column);
  std::string joints;
  for (std::size_t j = 0; j < bag_map.joint_names.size(); ++j) {
    joints += (j == 0 ? "" : ", ") + std::to_string(j) + " " + bag_map.joint_names[j];
  }
  if (map.empty()) notes->push_back(name + ": " + bag_map.name + " of joints " + joints);
  for (std::size_t j = 0; j < session.size(); ++j) {
    const auto rows = static_cast<std::size_t>(session[j].size());
    if (rows == messages) continue;
    notes->push_back(name + ": joint " + std::to_string(j) + ": " + std::to_string(rows) + " of " +
                     std::to_string(messages) + " messages have all of its columns");
  }
  return session;
}

}  // namespace

ImportResult ImportFiles(const std::vector<std::filesystem::path>& paths,
                         const std::filesystem::path& map, const std::filesystem::path& out,
                         const FindSchema& find_schema,
                         const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  ImportResult result;
  std::vector<Session> sessions;
  try {
    for (const std::filesystem::path& path : paths) {
      sessions.push_back(ReadFile(path, map, &result.notes));
      result.samples += TimesOf(sessions.back()).size();
    }
    WholeFileSink sink(out);
    McapWriter writer(sink);
    Check(writer.Open(), out);
    std::uint64_t done = 0;
    for (const Session& session : sessions) {
      for (const types::Run& run : session) {
        Check(writer.WriteMetadata({"sinew.import",
                                    {{"csv", std::filesystem::path(run.name).filename().string()},
                                     {"mapping", map.filename().string()},
                                     {"content_hash", run.content_hash},
                                     {"samples", std::to_string(run.size())}}}),
              out);
      }
    }
    RunImporter importer(find_schema, writer);
    for (const Session& session : sessions) {
      const std::uint64_t before = done;
      Check(importer.Add(session,
                         [&](Eigen::Index row) {
                           done = before + static_cast<std::uint64_t>(row);
                           if (progress) progress(done, result.samples);
                         }),
            out);
    }
    Check(writer.Close(), out);
    Check(sink.Commit(), out);
    result.runs = sessions.size();
    result.messages = writer.statistics().message_count;
    result.bytes = writer.bytes_written();
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  return result;
}

}  // namespace sinew::recording
