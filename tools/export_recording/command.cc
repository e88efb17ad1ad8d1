#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/config/whole_file.h"
#include "components/base/types/json_text.h"
#include "components/model/actuator/file/model_file.h"
#include "tools/export_recording/ros2_bag.h"
#include "tools/export_recording/tables.h"

namespace sinew::export_recording {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path recording, out, model;
  std::string format;
  std::vector<std::string> topics;
  bool json = false;
};

struct Exported {
  std::vector<Written> topics;
  std::vector<std::string> left_out;
  std::string cut_off;
};

// A folder that appears under its name when it is whole.
class WholeFolder {
 public:
  explicit WholeFolder(const fs::path& path) : path_(path), temporary_(config::PartPath(path)) {
    std::error_code error;
    if (!fs::create_directory(temporary_, error)) {
      throw UsageError(path.string() + ": cannot be made: " + error.message());
    }
  }
  ~WholeFolder() {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
  }
  WholeFolder(const WholeFolder&) = delete;
  WholeFolder& operator=(const WholeFolder&) = delete;

  const fs::path& path() const { return temporary_; }
  void Commit() {
    std::error_code error;
    fs::rename(temporary_, path_, error);
    if (error) throw UsageError(path_.string() + ": cannot be made: " + error.message());
  }

 private:
  fs::path path_, temporary_;
};

RosNames NamesOf(const fs::path& model) {
  RosNames names;
  if (model.empty()) return names;
  const actuator::RobotModel robot = actuator::LoadRobotModel(model);
  for (const actuator::JointModel& joint : robot.joints) names.joints.push_back(joint.name);
  if (robot.floating_base) {
    names.force_frames = robot.floating_base->force_links;
    names.imu_frame = robot.floating_base->imu_link;
  }
  return names;
}

Exported Export(const Options& options) {
  const fs::path out = (options.out / "").parent_path();  // "runs/" is "runs"
  if (fs::exists(out)) {
    throw UsageError(out.string() + ": is there already, expected a new name");
  }
  const bool bag = options.format == "ros2bag";
  if (bag && !options.topics.empty()) {
    throw UsageError("--topic is not for ros2bag, which has joint_state, imu and foot_force");
  }
  if (!bag && !options.model.empty()) {
    throw UsageError("--model names joints and links for ros2bag, expected no other format");
  }
  const recording::RecordingPath path = recording::ParseRecordingPath(options.recording);
  Exported exported;
  if (bag) {
    WholeFolder folder(out);
    RosBag written = WriteRosBag(path, NamesOf(options.model), folder.path());
    folder.Commit();
    exported = {std::move(written.topics), std::move(written.left_out), written.cut_off};
    return exported;
  }
  const Tables tables(path, {options.topics.begin(), options.topics.end()});
  exported.cut_off = tables.cut_off();
  for (const auto& [topic, why] : tables.left_out()) exported.left_out.push_back(topic);
  if (!tables.left_out().empty()) {
    std::cerr << recording::LeftOutText(options.recording.string(), tables.left_out()) << '\n';
  }
  if (options.format == "npz") {
    exported.topics = WriteNpz(tables, out);
    return exported;
  }
  WholeFolder folder(out);
  exported.topics = WriteCsv(tables, folder.path());
  folder.Commit();
  return exported;
}

void RunExport(const Options& options) {
  const Exported exported = Export(options);
  if (!exported.cut_off.empty()) {
    std::cerr << options.recording.string() << ": cut off (" << exported.cut_off
              << "), exported is what is whole\n";
  }
  if (options.json) {
    nlohmann::ordered_json topics = nlohmann::ordered_json::array();
    for (const Written& topic : exported.topics) {
      topics.push_back({{"topic", topic.topic}, {"messages", topic.messages}});
      if (topic.fields > 0) topics.back()["fields"] = topic.fields;
    }
    std::cout << types::JsonText(nlohmann::ordered_json{{"out", options.out.string()},
                                                        {"topics", topics},
                                                        {"left_out", exported.left_out},
                                                        {"cut_off", exported.cut_off}},
                                 2)
              << '\n';
    return;
  }
  std::size_t messages = 0;
  for (const Written& topic : exported.topics) messages += topic.messages;
  const std::size_t topics = exported.topics.size();
  std::cout << options.out.string() << ": " << messages << " messages of " << topics
            << (topics == 1 ? " topic\n" : " topics\n");
  if (exported.left_out.empty() || options.format != "ros2bag") return;
  std::cout << "not in a bag: ";
  for (std::size_t i = 0; i < exported.left_out.size(); ++i) {
    std::cout << (i > 0 ? ", " : "") << exported.left_out[i];
  }
  std::cout << '\n';
}

}  // namespace

void AddExportCommand(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("export", "A recording as CSV files, NumPy arrays or a bag of ROS 2");
  command->add_option("recording", options->recording, "Recording, or a part of it")
      ->required()
      ->type_name("FILE.mcap[@START:END]");
  command
      ->add_option("--format", options->format,
                   "csv: a folder with a file per topic; npz: one file of arrays; ros2bag: a "
                   "folder for ros2 bag")
      ->required()
      ->check(CLI::IsMember({"csv", "npz", "ros2bag"}));
  command->add_option("--out", options->out, "Folder or file to write; must not be there")
      ->required();
  command->add_option("--topic", options->topics, "Only this topic; may be repeated (csv, npz)")
      ->type_name("TOPIC");
  command
      ->add_option("--model", options->model,
                   "Names of joints and links (ros2bag): schema sinew-model/1")
      ->type_name("FILE.yaml");
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "Columns, arrays and topics: docs/interchange.md.\n\n"
      "Examples:\n"
      "  sinew export run.mcap --format csv --out run_csv --topic joint_state\n"
      "  sinew export run.mcap@2.5:10 --format npz --out run.npz\n"
      "  sinew export run.mcap --format ros2bag --model robots/biped/model.yaml --out run_bag");
  command->callback([options] { RunExport(*options); });
}

}  // namespace sinew::export_recording
