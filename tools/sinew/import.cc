#include "components/record/recording/file/import.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/base/types/printable.h"
#include "components/topics/node/topics.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/progress.h"

namespace sinew::tools {

namespace {

recording::TopicSchema FindSchema(std::string_view name) {
  const node::TopicInfo* topic = node::FindTopic(name);
  if (topic == nullptr)
    throw std::invalid_argument("no topic '" + std::string(name) + "' in this build");
  return {topic->name, topic->type_name, topic->idl, topic->idl_hash};
}

}  // namespace

void AddImportCommand(CLI::App& app) {
  struct Options {
    std::vector<std::filesystem::path> files;
    std::filesystem::path map;
    std::filesystem::path out;
    bool overwrite = false;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "import", "Measured data into an MCAP recording: CSV files by a mapping, bags of ROS 2");
  command
      ->add_option("files", options->files,
                   "CSV files; bags of ROS 2: a folder, .mcap or .db3. Each becomes a session of "
                   "the recording")
      ->required();
  command->add_option("--map", options->map,
                      "Mapping file (sinew-csv-map/1): column, signal, unit, sign; for a bag, when "
                      "left out, all joints of its JointState topic, effort as torque");
  command->add_option("--out", options->out, "The recording to write, FILE.mcap")->required();
  command->add_flag("--overwrite", options->overwrite, "Replace the file if it is there");
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "The recording holds joint_state, actuator_state and reference messages; every number is "
      "kept bit by\n"
      "bit. It is written as a whole or not at all. Formats: docs/formats.md.\n\nExample:\n"
      "  sinew import data.csv --map csv_map.yaml --out data.mcap\n"
      "  sinew import rosbag2_folder --out data.mcap");
  command->callback([options] {
    if (!options->overwrite && std::filesystem::exists(options->out)) {
      throw UsageError(options->out.string() +
                       ": is there already, expected a new name (or --overwrite)");
    }
    ProgressBar bar("import", "samples", 0);
    const recording::ImportResult result = recording::ImportFiles(
        options->files, options->map, options->out, FindSchema,
        [&bar](std::uint64_t done, std::uint64_t all) { bar.Update(done, all); });
    bar.Finish();
    for (const std::string& note : result.notes) std::cerr << types::Printable(note) << '\n';
    if (options->json) {
      std::cout << types::JsonText(nlohmann::ordered_json{{"file", options->out.string()},
                                                          {"sessions", result.runs},
                                                          {"samples", result.samples},
                                                          {"messages", result.messages},
                                                          {"bytes", result.bytes}})
                << '\n';
    } else {
      std::cout << options->out.string() << ": " << result.samples << " samples in " << result.runs
                << (result.runs == 1 ? " session, " : " sessions, ") << result.messages
                << " messages, " << result.bytes << " bytes\n";
    }
  });
}

}  // namespace sinew::tools
