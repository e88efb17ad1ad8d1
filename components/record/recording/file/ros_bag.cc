#include "components/record/recording/file/ros_bag.h"

#include <sqlite3.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/config/yaml_text.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/record/recording/file/csv_map_file.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"

namespace sinew::recording {
namespace {

namespace fs = std::filesystem;

// The profile in the header of an MCAP file, behind magic, opcode and length: a text with its size.
constexpr std::size_t kProfileAt = 8 + 1 + 8;
constexpr std::string_view kRos2Profile("\4\0\0\0ros2", 8);
constexpr struct {
  const char *field, *signal, *unit;
} kJointFields[] = {
    {"position", "position", "rad"}, {"velocity", "velocity", "rad/s"}, {"effort", "torque", "Nm"}};

void ReadMcap(const fs::path& path, RosTable* table, std::vector<std::string>* notes) {
  FileSource source(path);
  const McapReader reader(source);
  if (reader.recovery() && notes != nullptr) {
    notes->push_back(path.string() + ": cut off, read as far as it goes");
  }
  McapMessages messages = reader.Messages();
  McapMessage message;
  while (messages.Next(&message)) {
    const McapChannel& channel = reader.channels().at(message.channel_id);
    const McapSchema* schema = reader.SchemaOf(channel);
    table->Add({channel.topic, schema == nullptr ? "no schema" : schema->name,
                channel.message_encoding, message.log_time_ns, message.data},
               path.string());
  }
}

// rosbag2_storage_sqlite3/src/.../sqlite_storage.cpp has the tables.
void ReadSqlite(const fs::path& path, RosTable* table) {
  sqlite3* opened = nullptr;
  const auto check = [&](int status, int expected) {
    if (status == expected) return;
    throw UsageError(path.string() + ": " + sqlite3_errmsg(opened) +
                     ", expected a bag of ROS 2 (sqlite3)");
  };
  const int status = sqlite3_open_v2(path.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(opened, sqlite3_close);
  check(status, SQLITE_OK);
  sqlite3_stmt* prepared = nullptr;
  check(sqlite3_prepare_v2(opened,
                           "SELECT t.name, t.type, t.serialization_format, m.timestamp, m.data "
                           "FROM messages m JOIN topics t ON m.topic_id = t.id "
                           "ORDER BY m.timestamp, m.id",
                           -1, &prepared, nullptr),
        SQLITE_OK);
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> rows(prepared, sqlite3_finalize);
  const auto text = [&](int column) -> std::string {
    const unsigned char* found = sqlite3_column_text(prepared, column);
    return found == nullptr ? "" : reinterpret_cast<const char*>(found);
  };
  int step = SQLITE_ROW;
  while ((step = sqlite3_step(prepared)) == SQLITE_ROW) {
    const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(prepared, 4));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(prepared, 4));
    table->Add({text(0), text(1), text(2), sqlite3_column_int64(prepared, 3), {data, size}},
               path.string());
  }
  check(step, SQLITE_DONE);
}

// The files of a bag.
std::vector<fs::path> FilesOf(const fs::path& folder) {
  const fs::path file = folder / "metadata.yaml";
  if (!fs::exists(file)) {
    throw UsageError(folder.string() +
                     ": a folder without metadata.yaml, expected a bag of ROS 2 (`ros2 bag "
                     "reindex` writes a lost one)");
  }
  const std::string name = file.string();
  std::vector<fs::path> files;
  try {
    const YAML::Node bag =
        config::ParseYaml(config::ReadFile(file), name)["rosbag2_bagfile_information"];
    const auto mode = bag["compression_mode"].as<std::string>("");
    if (!mode.empty() && mode != "NONE" && mode != "none") {
      throw UsageError(name + ": compressed ('" + bag["compression_format"].as<std::string>("") +
                       "', by " + mode +
                       "), expected a bag without compression (`ros2 bag convert` writes one)");
    }
    // Early versions wrote the folder in front.
    for (const auto& path : bag["relative_file_paths"].as<std::vector<std::string>>()) {
      files.push_back(folder / fs::path(path).filename());
    }
  } catch (const YAML::Exception& error) {
    throw UsageError(name + ": " + error.msg + ", expected rosbag2_bagfile_information with " +
                     "relative_file_paths");
  }
  if (files.empty()) throw UsageError(name + ": relative_file_paths is empty, expected a file");
  return files;
}

}  // namespace

bool IsRosBag(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error) || path.extension() == ".db3") return true;
  if (path.extension() != ".mcap") return false;
  FileSource source(path);
  Bytes head(kProfileAt + kRos2Profile.size());
  return source.size() >= head.size() && source.Read(0, head).ok() &&
         Cursor::AsText(std::span(head).subspan(kProfileAt)) == kRos2Profile;
}

RosTable ReadRosBag(const fs::path& path, std::vector<std::string>* notes) {
  RosTable table(path.string());
  for (const fs::path& file :
       fs::is_directory(path) ? FilesOf(path) : std::vector<fs::path>{path}) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (error) throw UsageError(file.string() + ": " + error.message() + ", expected a file");
    if (size > config::kLargestData) {
      throw UsageError(file.string() + ": has " + std::to_string(size) +
                       " bytes, expected at most " + std::to_string(config::kLargestData));
    }
    try {
      if (file.extension() == ".mcap") {
        ReadMcap(file, &table, notes);
      } else {
        ReadSqlite(file, &table);
      }
    } catch (const McapError& broken) {
      throw UsageError(file.string() + ": " + broken.what());
    } catch (const std::invalid_argument& wrong) {
      throw UsageError(wrong.what());
    }
  }
  if (notes != nullptr) {
    for (const std::string& note : table.notes()) notes->push_back(path.string() + ": " + note);
  }
  return table;
}

CsvMap MapOfRosBag(const RosTable& table, const fs::path& path) {
  const std::vector<std::string> columns = table.Header({});
  const std::vector<RosTable::Joints> topics = table.joints();
  if (topics.size() != 1 || topics[0].fields.empty()) {
    throw UsageError(path.string() + ": has " + std::to_string(topics.size()) +
                     " topics of sensor_msgs/msg/JointState, expected one with numbers of all its "
                     "joints, or --map with some of its columns: " +
                     types::Joined(columns));
  }
  const RosTable::Joints& joints = topics[0];
  const auto column = [&](const std::string& field) {
    return "{column: " + types::JsonText(nlohmann::ordered_json(joints.topic + "/" + field)) +
           ", unit: ";
  };
  std::string text = std::string("schema: ") + kSchema + "\nkind: rotary\njoint_names: " +
                     types::JsonText(nlohmann::ordered_json(joints.names)) +
                     "\ntime: " + column("header/stamp") + "s}\nsignals:\n";
  std::vector<std::string> read;
  for (const auto& [field, signal, unit] : kJointFields) {
    if (std::find(joints.fields.begin(), joints.fields.end(), field) == joints.fields.end()) {
      continue;
    }
    text +=
        std::string("  ") + signal + ": " + column(std::string("{joint}/") + field) + unit + "}\n";
    read.push_back(std::string(field) + " (" + unit + ")");
  }
  return ParseCsvMap(text, joints.topic + ": " + types::Joined(read));
}

}  // namespace sinew::recording
