#include "tools/rerun/command.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/config/yaml_text.h"
#include "components/base/types/json_text.h"
#include "components/base/types/text.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_record.h"
#include "components/record/recording/message_type.h"
#include "components/topics/node/time_option.h"
#include "tools/compose/chain.h"
#include "tools/edited_yaml/edited_yaml.h"
#include "tools/inspect/message_text.h"
#include "tools/inspect/plot.h"
#include "tools/rerun/recorded_parts.h"
#include "tools/rerun/rerun.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/progress.h"

namespace sinew::rerun {
namespace {

// Components with other values in their configuration: what would they have done?
struct Edit {
  std::string component;  // empty: every one that has the entry
  std::string key;
  std::string value;  // YAML; a path relative to the working folder where it names a file
};

namespace fs = std::filesystem;

YAML::Node ValueOf(const Edit& edit) {
  std::error_code ignored;
  if (fs::is_regular_file(edit.value, ignored))
    return YAML::Node(fs::absolute(edit.value).string());
  return config::ParseYaml(edit.value, "--with " + edit.key);
}

// KEY=VALUE or COMPONENT.KEY=VALUE. Throws UsageError.
Edit ParseEdit(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string path = text.substr(0, equals);
  const std::size_t dot = path.rfind('.');
  Edit edit;
  edit.key = dot == std::string::npos ? path : path.substr(dot + 1);
  if (dot != std::string::npos) edit.component = path.substr(0, dot);
  if (equals == std::string::npos || edit.key.empty() || dot == 0) {
    throw UsageError("--with " + text + ": expected KEY=VALUE or COMPONENT.KEY=VALUE");
  }
  edit.value = text.substr(equals + 1);
  return edit;
}

// The parts whose configurations have an entry that an edit changes, at any depth, with
// configurations as folder/NAME.yaml; their paths stay those of the originals. Throws UsageError:
// an edit that changes nothing, a value that is no YAML, files.
std::vector<compose::Part> EditParts(const std::vector<compose::Part>& parts,
                                     const std::vector<Edit>& edits, const fs::path& folder) {
  std::vector<compose::Part> edited;
  std::vector<int> changed(edits.size(), 0);
  std::vector<YAML::Node> values;
  values.reserve(edits.size());
  for (const Edit& edit : edits) values.push_back(ValueOf(edit));
  for (const compose::Part& part : parts) {
    if (part.config.empty()) continue;
    YAML::Node root = edited_yaml::LoadYaml(part.config);
    int count = 0;
    for (std::size_t i = 0; i < edits.size(); ++i) {
      const Edit& edit = edits[i];
      if (!edit.component.empty() && edit.component != part.name) continue;
      const int entries = edited_yaml::ReplaceEntries(root, edit.key, values[i]);
      changed[i] += entries;
      count += entries;
    }
    if (count == 0) continue;
    edited_yaml::MakePathsAbsolute(root, part.config.parent_path());
    compose::Part copy = part;
    copy.config = folder / (part.name + ".yaml");
    config::WriteFileAtomically(copy.config, edited_yaml::YamlText(root));
    edited.push_back(std::move(copy));
  }
  for (std::size_t i = 0; i < edits.size(); ++i) {
    if (changed[i] > 0) continue;
    const Edit& edit = edits[i];
    throw UsageError(edit.component.empty()
                         ? "--with " + edit.key +
                               ": no configuration has such an entry, expected "
                               "a key that is written there"
                         : "--with " + edit.component + "." + edit.key + ": '" + edit.component +
                               "' is not run again, or its configuration has no such entry");
  }
  return edited;
}

struct RerunOptions {
  fs::path recording, deployment;
  std::vector<std::string> components;
  std::vector<std::string> settings;
  std::vector<std::string> edits;
  std::string field;
  fs::path picture;
  std::size_t session = 1;
  std::optional<double> from_s;
  bool all_differences = false;
  bool json = false;
};

// A folder of files that are read, for as long as they are.
class TemporaryFiles {
 public:
  TemporaryFiles() {
    std::string name = (fs::temp_directory_path() / "sinew_rerun.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw UsageError(name + ": the folder cannot be made");
    }
    path_ = name;
  }
  ~TemporaryFiles() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFiles(const TemporaryFiles&) = delete;
  TemporaryFiles& operator=(const TemporaryFiles&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string Fixed(double value, int digits) { return types::Text("%.*f", digits, value); }

const char* VerdictWord(Verdict verdict) {
  switch (verdict) {
    case Verdict::kIdentical:
      return "identical";
    case Verdict::kDiffers:
      return "differs";
    case Verdict::kInputLost:
      return "input lost";
    case Verdict::kOutputLost:
      return "output lost";
    case Verdict::kNothing:
      break;
  }
  return "nothing recorded";
}

// The result of a component, one line.
std::string LineOf(const ComponentResult& result, double period_s) {
  std::string line = result.name + ": " + VerdictWord(result.verdict);
  const auto at = [&](std::uint64_t tick) {
    return "tick " + std::to_string(tick) + " (" + Fixed(static_cast<double>(tick) * period_s, 3) +
           " s)";
  };
  if (result.difference) {
    const Difference& difference = *result.difference;
    line += " at " + at(difference.tick) + ": " + difference.topic + "." + difference.field.field +
            " was " + difference.field.recorded + ", is now " + difference.field.rerun + " (byte " +
            std::to_string(difference.field.byte) + " of the payload)";
  }
  if (!result.lost.empty()) line += ": " + result.lost;
  if (result.from_tick) line += "; from the snapshot of tick " + std::to_string(*result.from_tick);
  return line + "; " + std::to_string(result.messages) + " messages of " +
         std::to_string(result.ticks) + " ticks compared";
}

void PrintText(const RerunOptions& options, std::size_t sessions, const RerunResult& result) {
  std::cout << options.recording.string() << ": session " << options.session << " of " << sessions
            << ", " << (result.lockstep ? "lockstep" : "real time") << ", "
            << Fixed(result.recorded_s(), 1) << " s run again in " << Fixed(result.wall_s, 1)
            << " s\n";
  for (const ComponentResult& component : result.components) {
    std::cout << "  " << LineOf(component, result.session.period_s) << '\n';
    for (const FieldSummary& field : component.differences) {
      std::cout << "    " << field.topic << '.' << field.field << ": in " << field.ticks
                << " ticks from " << field.first_tick << ", rms " << field.rms << ", largest "
                << field.largest << " at tick " << field.largest_tick << '\n';
    }
  }
}

nlohmann::ordered_json JsonOf(const ComponentResult& result) {
  nlohmann::ordered_json one = {{"name", result.name},
                                {"verdict", VerdictWord(result.verdict)},
                                {"from_tick", result.from_tick.value_or(0)},
                                {"ticks", result.ticks},
                                {"messages", result.messages}};
  if (result.difference) {
    const Difference& difference = *result.difference;
    one["difference"] = {{"topic", difference.topic},
                         {"tick", difference.tick},
                         {"field", difference.field.field},
                         {"byte", difference.field.byte},
                         {"recorded", difference.field.recorded},
                         {"rerun", difference.field.rerun}};
  }
  for (const FieldSummary& field : result.differences) {
    one["fields"].push_back({{"topic", field.topic},
                             {"field", field.field},
                             {"ticks", field.ticks},
                             {"first_tick", field.first_tick},
                             {"rms", field.rms},
                             {"largest", field.largest},
                             {"largest_tick", field.largest_tick}});
  }
  if (!result.lost.empty()) {
    one["lost"] = result.lost;
    one["lost_tick"] = result.lost_tick;
  }
  return one;
}

void PrintJson(const RerunResult& result) {
  nlohmann::ordered_json report = {
      {"identical", result.identical()}, {"mode", result.lockstep ? "lockstep" : "realtime"},
      {"session_id", result.session.id}, {"recorded_s", result.recorded_s()},
      {"wall_s", result.wall_s},         {"components", nlohmann::ordered_json::array()}};
  for (const ComponentResult& component : result.components) {
    report["components"].push_back(JsonOf(component));
  }
  std::cout << types::JsonText(report, 2) << '\n';
}

RerunInput::Field ParseField(const std::string& text) {
  const inspect::TopicField parts = inspect::SplitField(text);
  if (parts.topic.empty() || parts.field.empty()) {
    throw UsageError("--field " + text +
                     ": expected TOPIC.FIELD, e.g. joint_command.position_rad[0]");
  }
  return {parts.topic, parts.field};
}

// The field of a picture when none was named: the first number that differs.
RerunInput::Field FirstField(const RerunResult& result) {
  for (const ComponentResult& component : result.components) {
    for (const FieldSummary& field : component.differences) {
      if (field.largest != 0.0 && field.field.find("[]") == std::string::npos) {
        return {field.topic, field.field};
      }
    }
  }
  throw UsageError("--png: nothing differs, expected --field TOPIC.FIELD");
}

// Recorded and run again in one panel, their difference in one below.
void WritePicture(const fs::path& path, const FieldCurve& curve) {
  const std::string name = curve.topic + "." + curve.field;
  std::vector<inspect::Curve> curves;
  for (const char* what : {", recorded", ", run again", ", run again - recorded"}) {
    curves.push_back(inspect::CurveOf(name + what, curve.field));
    curves.back().time_s = curve.time_s;
  }
  curves[0].value = curve.recorded;
  curves[1].value = curve.rerun;
  for (std::size_t i = 0; i < curve.rerun.size(); ++i) {
    curves[2].value.push_back(curve.rerun[i] - curve.recorded[i]);
  }
  curves[2].quantity = "difference";
  curves[2].apart = true;
  config::WriteFileAtomically(path, inspect::DrawnPicture(curves, "png"));
}

// Exit code.
int RunCommand(const RerunOptions& options) {
  const std::string file = options.recording.string();
  node::StopFlag stop;
  recording::FileSource source(options.recording);
  const recording::McapReader reader(source);
  if (const recording::LeftOut foreign = recording::NotReadableTopics(reader); !foreign.empty()) {
    std::cerr << recording::LeftOutText(file, foreign) << '\n';
  }
  const std::vector<Session> sessions = SessionsOf(reader, file);
  if (options.session > sessions.size()) {
    throw UsageError(file + ": session " + std::to_string(options.session) + ", expected 1 to " +
                     std::to_string(sessions.size()));
  }
  const TemporaryFiles folder, edited;
  launch::Overrides overrides;
  overrides.settings = options.settings;
  overrides.host = launch::kAllHosts;
  const launch::Deployment deployment = launch::LoadDeployment(
      options.deployment.empty() ? UnpackDeployment(reader, file, folder.path())
                                 : options.deployment,
      overrides);
  RerunInput input{
      .file = file,
      .session = sessions[options.session - 1],
      .mode = ModeOf(reader, file,
                     deployment.lockstep ? node::TimeMode::kLockstep : node::TimeMode::kRealtime),
      .parts = PartsOf(deployment, options.components),
      .from_s = options.from_s,
      .all_differences = options.all_differences || !options.picture.empty()};
  if (!options.edits.empty()) {
    std::vector<Edit> edits;
    for (const std::string& text : options.edits) edits.push_back(ParseEdit(text));
    input.parts = EditParts(input.parts, edits, edited.path());
    input.all_differences = true;
  }
  if (!options.field.empty()) input.curve = ParseField(options.field);
  const auto run = [&] {
    tools::ProgressBar bar("rerun", "ticks", input.session.last_tick + 1);
    RerunResult result =
        Rerun(reader, input, stop, [&](std::uint64_t done, std::uint64_t) { bar.Update(done); });
    bar.Finish();
    return result;
  };
  RerunResult result = run();
  if (!options.picture.empty()) {
    if (!input.curve) {
      input.curve = FirstField(result);
      result = run();
    }
    WritePicture(options.picture, *result.curve);
  }
  options.json ? PrintJson(result) : PrintText(options, sessions.size(), result);
  return result.identical() ? 0 : 1;
}

}  // namespace

void AddRerunCommand(CLI::App& app) {
  auto options = std::make_shared<RerunOptions>();
  CLI::App* command = app.add_subcommand(
      "rerun", "Run components again on a recording's inputs, and compare to the byte");
  command->add_option("recording", options->recording, "A recording with inputs and outputs")
      ->required()
      ->type_name("FILE.mcap");
  command
      ->add_option("--component", options->components,
                   "Processes of the deployment, NAME,NAME; all that can run in process by default")
      ->delimiter(',')
      ->type_name("PROCESS");
  command
      ->add_option("--deployment", options->deployment,
                   "Deployment that was recorded; the attached one by default")
      ->type_name("FILE.yaml");
  command->add_option("--set", options->settings,
                      "KEY=VALUE, as it was given to `sinew launch`; may be repeated");
  command->add_option("--session", options->session, "Of a recording with several, from 1")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--from", options->from_s,
                   "Seconds: each component from its last snapshot up to here")
      ->check(node::IsTime(node::Zero::kAllowed));
  command
      ->add_option(
          "--with", options->edits,
          "[COMPONENT.]KEY=VALUE, may be repeated: what would the components have done that "
          "have this entry in their configuration?")
      ->type_name("EDIT");
  command
      ->add_option("--png", options->picture,
                   "Picture of a field, recorded and run again, and the difference")
      ->type_name("FILE.png");
  command
      ->add_option("--field", options->field,
                   "Of the picture; the first number that differs by default")
      ->type_name("TOPIC.FIELD");
  command->add_flag("--all-differences", options->all_differences,
                    "Go on after the first difference, and sum up all of them by field");
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "Exit code 0: identical; 1: not.\n\n"
      "Examples:\n"
      "  sinew rerun run.mcap --deployment deploy_esn.yaml\n"
      "  sinew rerun run.mcap --deployment deploy_esn.yaml --component esn,control --from 30\n"
      "  sinew rerun run.mcap --with model=found/model.yaml --png torque.png \\\n"
      "    --field joint_command.motor_torque_Nm[0]");
  command->callback([options] {
    tools::StartCommandLog("rerun");
    int exit_code = 1;
    try {
      exit_code = RunCommand(*options);
    } catch (const recording::McapError& error) {
      throw UsageError(options->recording.string() + ": " + error.what());
    }
    if (exit_code != 0) throw CLI::RuntimeError(exit_code);
  });
}

}  // namespace sinew::rerun
