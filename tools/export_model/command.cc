#include "tools/export_model/command.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/actuator/file/model_file.h"
#include "components/arm/file/urdf_file.h"
#include "components/config/config.h"
#include "components/identify/file/processing_file.h"
#include "components/recording/file/run_reader.h"
#include "tools/export_model/cost.h"
#include "tools/export_model/described_robot.h"
#include "tools/export_model/remarks.h"
#include "tools/export_model/write_model.h"
#include "tools/sinew/shipped.h"

namespace sinew::export_model {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path model, out, urdf, map;
  std::string format;
  std::vector<std::string> recordings;
  double horizon_s = 0.5;
  bool json = false;
};

Format FormatOf(const std::string& name) {
  return name == "mjcf" ? Format::kMjcf : name == "urdf" ? Format::kUrdf : Format::kSdf;
}

std::vector<Cost> Costs(const Options& options, const actuator::ModelFile& file,
                        const std::vector<Dropped>& dropped) {
  if (options.recordings.empty()) return {};
  if (file.robot.joints.size() != 1) {
    throw UsageError("--recording: " + options.model.string() + " has " +
                     std::to_string(file.robot.joints.size()) +
                     " joints, expected 1: a joint alone is simulated beside a recording");
  }
  const fs::path map = options.map.empty() ? tools::DefaultCsvMap(options.model) : options.map;
  std::vector<types::Run> runs;
  for (const std::string& recording : options.recordings) {
    std::vector<types::Run> some = recording::ReadRuns(recording, map);
    if (some.empty()) throw UsageError(recording + ": no run of joint 0, expected joint_state");
    for (types::Run& run : some) runs.push_back(std::move(run));
  }
  try {
    const identify::ProcessingOptions processing =
        identify::Resolve(identify::ReadProcessing(file.root, file.robot.joints[0].kind), runs);
    return CostsOf(dropped, file.robot, runs, processing, options.horizon_s);
  } catch (const std::invalid_argument& error) {
    throw UsageError(options.recordings.front() + " with " + options.model.string() + ": " +
                     error.what());
  }
}

std::string NamesOf(const std::vector<std::string>& recordings) {
  std::string names;
  for (const std::string& recording : recordings) {
    names += (names.empty() ? "" : ", ") + fs::path(recording).filename().string();
  }
  return names;
}

nlohmann::ordered_json ToJson(const Options& options, const std::vector<Dropped>& dropped,
                              const std::vector<Cost>& costs) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < std::max(dropped.size(), costs.size()); ++i) {
    nlohmann::ordered_json entry;
    if (i < dropped.size()) {
      entry = {{"joint", dropped[i].joint},
               {"effect", dropped[i].effect},
               {"parameters", dropped[i].parameters}};
    } else {
      entry = {{"effect", costs[i].effect}};
    }
    if (i < costs.size()) {
      const auto number = [](const std::optional<double>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
      };
      entry["rms_without"] = number(costs[i].without);
      entry["rms_with"] = number(costs[i].with);
      if (!costs[i].why_not.empty()) entry["why_not"] = costs[i].why_not;
    }
    list.push_back(std::move(entry));
  }
  return {{"out", options.out.string()}, {"format", options.format}, {"dropped", list}};
}

void RunExportModel(const Options& options) {
  if (options.json && options.out.empty()) {
    throw UsageError("--json describes the written file, expected --out FILE as well");
  }
  actuator::ModelFile file = actuator::LoadModelFile(options.model);
  if (!options.urdf.empty()) file.robot.urdf_path = options.urdf.string();
  if (file.robot.urdf_path.empty()) {
    throw UsageError(options.model.string() + ": names no urdf, expected one, or --urdf FILE");
  }
  const Format format = FormatOf(options.format);
  const std::string urdf = config::ReadFile(file.robot.urdf_path);
  const std::vector<Dropped> dropped = DroppedBy(format, file.robot);
  std::string text;
  std::vector<Cost> costs;
  Remarks remarks;
  try {
    const DescribedRobot robot = Describe(file.robot, arm::ParseUrdf(urdf, file.robot.urdf_path));
    costs = Costs(options, file, dropped);
    remarks = MakeRemarks(format, file.robot, options.model.filename().string(), dropped, costs,
                          NamesOf(options.recordings), file.robot.joints.front().kind);
    text = format == Format::kMjcf   ? WriteMjcf(robot, remarks)
           : format == Format::kUrdf ? WriteUrdf(robot, urdf, remarks)
                                     : WriteSdf(robot, remarks);
  } catch (const std::invalid_argument& error) {
    throw UsageError(options.model.string() + ": " + error.what());
  }
  if (options.out.empty()) {
    std::cout << text;
    return;
  }
  config::WriteFileAtomically(options.out, text);
  if (options.json) {
    std::cout << ToJson(options, dropped, costs).dump(2) << '\n';
    return;
  }
  std::cout << options.out.string() << '\n';
  for (const std::string& remark : remarks) std::cout << "  " << remark << '\n';
}

}  // namespace

void AddExportModelCommand(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("export-model", "A model file for MuJoCo, as a URDF or for Gazebo");
  command->add_option("model", options->model, "Model file (schema sinew-model/1)")
      ->required()
      ->type_name("FILE.yaml")
      ->check(CLI::ExistingFile);
  command->add_option("--format", options->format, "mjcf: MuJoCo; urdf; sdf: Gazebo")
      ->required()
      ->check(CLI::IsMember({"mjcf", "urdf", "sdf"}));
  command->add_option("--out", options->out, "File to write; else it is printed");
  command->add_option("--urdf", options->urdf, "In place of the model file's")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--recording", options->recordings,
                   "Held-out CSV or MCAP: what each effect costs that the format does not carry; "
                   "may be repeated")
      ->type_name("FILE");
  command->add_option("--map", options->map, "Mapping of CSV columns")->check(CLI::ExistingFile);
  command->add_option("--horizon", options->horizon_s, "Length of a simulated piece, s")
      ->check(CLI::Range(0.02, 100.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "What was dropped, as JSON");
  command->footer(
      "What each format carries: docs/interchange.md.\n\n"
      "Examples:\n"
      "  sinew export-model found/model.yaml --format mjcf --recording held_out.mcap --out "
      "rig.xml\n"
      "  sinew export-model robots/biped/model.yaml --format sdf --out biped.sdf");
  command->callback([options] { RunExportModel(*options); });
}

}  // namespace sinew::export_model
