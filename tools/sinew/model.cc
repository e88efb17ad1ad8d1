#include "components/model/actuator/model.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "components/base/types/json_text.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/effects/effect.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

using actuator::JointModel;
using actuator::ParameterValue;
using actuator::RobotModel;
using actuator::Term;

struct ModelOptions {
  std::string input, output;
  bool json = false;
};

using Visit = std::function<void(const std::string& key, const ParameterValue& value)>;

void ForEachParameter(const Term& term, types::JointKind kind, const Visit& visit) {
  const effects::EffectInfo& info = term.effect->info();
  for (std::size_t i = 0; i < info.linear.size(); ++i) {
    visit(effects::ParameterKey(info.linear[i], kind), term.linear[i]);
  }
  for (std::size_t i = 0; i < info.nonlinear.size(); ++i) {
    visit(effects::ParameterKey(info.nonlinear[i], kind), term.nonlinear[i]);
  }
}

void PrintText(const RobotModel& robot) {
  std::cout << robot.name << '\n';
  for (const JointModel& joint : robot.joints) {
    std::cout << "joint " << joint.name << " ("
              << (joint.kind == types::JointKind::kRevolute ? "rotary" : "linear") << ")\n";
    for (const Term& term : joint.terms) {
      std::cout << "  " << term.effect->info().name << (term.declared ? "" : " (added)") << ": "
                << term.effect->info().formula << '\n';
      ForEachParameter(term, joint.kind, [](const std::string& key, const ParameterValue& value) {
        std::cout << "    " << key << " = " << value.value;
        if (value.half_width_95) std::cout << " +- " << *value.half_width_95 << " (95 %)";
        if (value.tolerance > 0.0)
          std::cout << ", declared within " << 100.0 * value.tolerance << " %";
        if (value.tolerance_absolute > 0.0)
          std::cout << ", declared within " << value.tolerance_absolute;
        std::cout << (value.fixed ? ", fixed" : "") << '\n';
      });
    }
    for (const actuator::HistoryEntry& entry : joint.history) {
      std::cout << "  " << entry.when << ": " << entry.effect << " from " << entry.recording
                << (entry.note.empty() ? "" : " (" + entry.note + ")") << '\n';
    }
  }
}

nlohmann::ordered_json ToJson(const JointModel& joint) {
  nlohmann::ordered_json terms = nlohmann::ordered_json::array();
  for (const Term& term : joint.terms) {
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
    ForEachParameter(
        term, joint.kind, [&parameters](const std::string& key, const ParameterValue& value) {
          nlohmann::ordered_json entry = {
              {"value", value.value}, {"tolerance", value.tolerance}, {"fixed", value.fixed}};
          if (value.tolerance_absolute > 0.0)
            entry["tolerance_absolute"] = value.tolerance_absolute;
          if (value.half_width_95) entry["half_width_95"] = *value.half_width_95;
          parameters[key] = std::move(entry);
        });
    terms.push_back({{"effect", term.effect->info().name},
                     {"declared", term.declared},
                     {"parameters", parameters}});
  }
  nlohmann::ordered_json history = nlohmann::ordered_json::array();
  for (const actuator::HistoryEntry& entry : joint.history) {
    history.push_back({{"when", entry.when},
                       {"effect", entry.effect},
                       {"recording", entry.recording},
                       {"note", entry.note}});
  }
  return {{"name", joint.name},
          {"kind", joint.kind == types::JointKind::kRevolute ? "rotary" : "linear"},
          {"terms", terms},
          {"history", history}};
}

void Show(const ModelOptions& options) {
  const RobotModel robot = actuator::LoadModelFile(options.input).robot;
  if (!options.json) {
    PrintText(robot);
    return;
  }
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  for (const JointModel& joint : robot.joints) joints.push_back(ToJson(joint));
  std::cout << types::JsonText(nlohmann::ordered_json{{"name", robot.name}, {"joints", joints}}, 2)
            << '\n';
}

void FromRig(const ModelOptions& options) {
  const RobotModel robot = actuator::LoadRigJson(options.input);
  if (options.output.empty() || options.output == "-") {
    std::cout << actuator::FormatModel(robot, {}, std::filesystem::current_path());
  } else {
    actuator::SaveRobotModel(options.output, robot);
  }
}

}  // namespace

void AddModelCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("model", "Show a model file, or make one");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  sinew model show robots/rig/model.yaml\n"
      "  sinew model from-rig rig.json --out model.yaml");

  auto show_options = std::make_shared<ModelOptions>();
  CLI::App* show = command->add_subcommand("show", "Terms and parameters of a model file");
  show->add_option("model", show_options->input, "Model file (schema sinew-model/1) or rig.json")
      ->required()
      ->type_name("FILE.yaml");
  show->add_flag("--json", show_options->json, "As JSON");
  show->callback([show_options] { Show(*show_options); });

  auto rig_options = std::make_shared<ModelOptions>();
  CLI::App* from_rig = command->add_subcommand(
      "from-rig", "A model file from what a laboratory declares of its rig (rig.json)");
  from_rig->add_option("rig", rig_options->input, "Constants and nominal parameters as JSON")
      ->required()
      ->type_name("FILE.json");
  from_rig->add_option("--out", rig_options->output, "Model file to write; else it is printed")
      ->type_name("FILE.yaml");
  from_rig->callback([rig_options] { FromRig(*rig_options); });
}

}  // namespace sinew::tools
