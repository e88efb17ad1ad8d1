#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/identify/interpolated.h"
#include "components/record/recording/file/run_reader.h"
#include "tools/export_model/cost.h"
#include "tools/export_model/described_robot.h"
#include "tools/export_model/write_model.h"
#include "tools/sinew/recordings.h"
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

std::vector<types::Run> RunsOfJoint(const Options& options, std::size_t joint) {
  const fs::path map = options.map.empty() ? tools::DefaultCsvMap(options.model) : options.map;
  std::vector<types::Run> runs;
  for (const std::string& recording : options.recordings) {
    std::vector<types::Run> some = recording::ReadRuns(recording, map, static_cast<int>(joint));
    if (some.empty()) {
      throw UsageError(recording + ": no run of joint " + std::to_string(joint) +
                       ", expected joint_state");
    }
    for (types::Run& run : some) runs.push_back(std::move(run));
  }
  return runs;
}

Costs ReadCosts(const Options& options, const actuator::ModelFile& file, const arm::Chain& chain,
                const std::vector<Dropped>& dropped) {
  if (options.recordings.empty()) return {};
  RequireFixedBase(file.robot);
  std::vector<std::vector<types::Run>> runs;
  for (std::size_t j = 0; j < file.robot.joints.size(); ++j) {
    runs.push_back(RunsOfJoint(options, j));
  }
  const identify::ProcessingOptions wished =
      identify::ReadProcessing(file.root, file.robot.joints[0].kind);
  try {
    if (runs.size() == 1) {
      return CostsOf(dropped, file.robot, runs[0], identify::Resolve(wished, runs[0]),
                     options.horizon_s);
    }
    // As close-loop reads them for the same balance.
    for (std::vector<types::Run>& of_joint : runs) {
      for (types::Run& run : of_joint) run = identify::WithoutInterpolatedRows(std::move(run));
    }
    return TorqueCostsOf(dropped, file.robot, chain, runs, wished);
  } catch (const std::invalid_argument& error) {
    throw UsageError(options.recordings.front() + " with " + options.model.string() + ": " +
                     error.what());
  }
}

std::string NamesOf(const std::vector<std::string>& recordings) {
  return types::Joined(recordings, ", ", [](const std::string& recording) {
    return fs::path(recording).filename().string();
  });
}

nlohmann::ordered_json ToJson(const Options& options, const std::vector<Dropped>& dropped,
                              const Costs& costs, const actuator::RobotModel& robot) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < std::max(dropped.size(), costs.of.size()); ++i) {
    nlohmann::ordered_json entry;
    if (i < dropped.size()) {
      entry = {{"joint", dropped[i].joint},
               {"effect", dropped[i].effect},
               {"parameters", dropped[i].parameters}};
    } else {
      entry = {{"joint", costs.of[i].joint}, {"effect", costs.of[i].effect}};
    }
    if (i < costs.of.size()) {
      const Cost& cost = costs.of[i];
      const auto number = [](const std::optional<double>& value) {
        return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
      };
      entry["unit"] = UnitOf(costs.measure, robot, cost.joint);
      entry["rms_without"] = number(cost.without);
      entry["rms_with"] = number(cost.with);
      if (!cost.why_not.empty()) entry["why_not"] = cost.why_not;
    }
    list.push_back(std::move(entry));
  }
  nlohmann::ordered_json out = {{"out", options.out.string()}, {"format", options.format}};
  if (!costs.of.empty()) out["measure"] = MeasureName(costs.measure);
  out["dropped"] = list;
  return out;
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
  Costs costs;
  Remarks remarks;
  try {
    const arm::Chain chain = arm::ParseUrdf(urdf, file.robot.urdf_path);
    const DescribedRobot robot = Describe(file.robot, chain);
    costs = ReadCosts(options, file, chain, dropped);
    remarks =
        MakeRemarks(format, file.robot, robot.links.chain.base, options.model.filename().string(),
                    dropped, costs, NamesOf(options.recordings));
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
    std::cout << types::JsonText(ToJson(options, dropped, costs, file.robot), 2) << '\n';
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
  tools::AddRecordings(
      *command, "--recording", &options->recordings,
      "Held-out CSV or MCAP: what each effect costs that the format does not carry");
  command->add_option("--map", options->map, "Mapping of CSV columns")->check(CLI::ExistingFile);
  command->add_option("--horizon", options->horizon_s, "Length of a simulated piece, s")
      ->check(CLI::Range(0.02, 100.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "What was dropped, as JSON");
  command->footer(
      "What each format carries: docs/interchange.md.\n\n"
      "Examples:\n"
      "  sinew export-model found/model.yaml held_out.mcap --format mjcf --out rig.xml\n"
      "  sinew export-model robots/biped/model.yaml --format sdf --out biped.sdf");
  command->callback([options] { RunExportModel(*options); });
}

}  // namespace sinew::export_model
