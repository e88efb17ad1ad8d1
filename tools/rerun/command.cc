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

#include "components/config/config.h"
#include "components/recording/file/file_io.h"
#include "components/recording/mcap_record.h"
#include "tools/rerun/recorded_parts.h"
#include "tools/rerun/rerun.h"
#include "tools/sinew/progress.h"

namespace sinew::rerun {
namespace {

namespace fs = std::filesystem;

struct RerunOptions {
  fs::path recording, deployment;
  std::vector<std::string> components;
  std::vector<std::string> settings;
  std::size_t session = 1;
  std::optional<double> from_s;
  bool all_differences = false;
  bool json = false;
};

// Of the files of a recording, for as long as they are read.
class UnpackedFolder {
 public:
  UnpackedFolder() {
    std::string name = (fs::temp_directory_path() / "sinew_rerun.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw UsageError(name + ": the folder cannot be made");
    }
    path_ = name;
  }
  ~UnpackedFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  UnpackedFolder(const UnpackedFolder&) = delete;
  UnpackedFolder& operator=(const UnpackedFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string Fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

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

// What was found of a component, one line.
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
  std::cout << report.dump(2) << '\n';
}

// Exit code.
int RunCommand(const RerunOptions& options) {
  const std::string file = options.recording.string();
  node::StopFlag stop;
  recording::FileSource source(options.recording);
  const recording::McapReader reader(source);
  const std::vector<Session> sessions = SessionsOf(reader, file);
  if (options.session > sessions.size()) {
    throw UsageError(file + ": session " + std::to_string(options.session) + ", expected 1 to " +
                     std::to_string(sessions.size()));
  }
  const UnpackedFolder folder;
  launch::Overrides overrides;
  overrides.settings = options.settings;
  const launch::Deployment deployment = launch::LoadDeployment(
      options.deployment.empty() ? UnpackDeployment(reader, file, folder.path())
                                 : options.deployment,
      overrides);
  RerunInput input{.file = file,
                   .session = sessions[options.session - 1],
                   .mode = ModeOf(reader, file),
                   .parts = PartsOf(deployment, options.components),
                   .from_s = options.from_s,
                   .all_differences = options.all_differences};
  tools::ProgressBar bar("rerun", "ticks", input.session.last_tick + 1);
  const RerunResult result =
      Rerun(reader, input, stop, [&](std::uint64_t done, std::uint64_t) { bar.Update(done); });
  bar.Finish();
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
      ->type_name("NAME");
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
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--all-differences", options->all_differences,
                    "Go on after the first difference, and sum up all of them by field");
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "Exit code 0: identical; 1: not.\n\n"
      "Examples:\n"
      "  sinew rerun run.mcap --deployment deploy_esn.yaml\n"
      "  sinew rerun run.mcap --deployment deploy_esn.yaml --component esn,control --from 30");
  command->callback([options] {
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
