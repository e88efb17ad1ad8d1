#include "components/model/close_loop/close_loop.h"

#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <climits>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "components/base/types/json_text.h"
#include "components/model/close_loop/input.h"
#include "components/model/gate/rules.h"
#include "components/model/report/file/report_file.h"
#include "components/model/report/file/section_file.h"
#include "components/model/trace/rules.h"
#include "components/topics/node/host_name.h"
#include "components/topics/node/version.h"
#include "sim/plant/joint_body.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/recordings.h"
#include "tools/sinew/shipped.h"

namespace sinew::tools {

namespace {

constexpr const char* kNoEffect = "none";          // of --effect
constexpr const char* kSimulation = "simulation";  // of --by

template <class Rules>
std::vector<std::string> IdsOf(const Rules& rules) {
  std::vector<std::string> ids;
  for (const auto& rule : rules) ids.emplace_back(rule.id);
  return ids;
}

// Memory that was freed is used again and not handed back: an analysis makes and drops large
// matrices, and fresh pages for each of them took half of its time.
void KeepMemory() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
  mallopt(M_TOP_PAD, 64 << 20);
}

// Date, host, version and command, for the end of a page.
std::string Made() {
  std::string words = config::ReadFile("/proc/self/cmdline", 1 << 20);
  while (!words.empty() && words.back() == '\0') words.pop_back();
  std::replace(words.begin(), words.end(), '\0', ' ');
  return types::UtcNow() + " on " + node::HostName() + ", sinew " + node::kVersion + ": " + words;
}

void Execute(close_loop::Options options, const std::filesystem::path& out, bool json) {
  KeepMemory();
  ProgressBar bar("close-loop", "%", 100);
  options.body = plant::JointAlone();
  options.progress = [&bar](double share) {
    bar.Update(static_cast<std::uint64_t>(100.0 * share));
  };
  const close_loop::Result result = close_loop::CloseLoop(options);
  close_loop::Write(result, out, Made());
  bar.Finish();
  if (json) {
    std::cout << result.json;
    return;
  }
  PrintPage(result.page);
  std::cout << "written: " << (out / "report.html").string() << ", report.json"
            << (result.assessed ? ", model.yaml" : "")
            << (result.parts.empty() ? "\n"
                                     : ", and a report of each joint in a folder of its name\n");
}

void AddModelOptions(close_loop::Options* options, CLI::App* command) {
  options->rig = RobotsFolder() / "rig";
  command->add_option(
      "--model", options->model,
      "Model file (sinew-model/1) or a laboratory's rig.json; the rig's by default");
  command->add_option("--map", options->map,
                      "Mapping of CSV columns (sinew-csv-map/1); csv_map.yaml beside the model by "
                      "default, else the rig's");
}

void AddAcceptFault(close_loop::Options* options, CLI::App* command, const char* help) {
  command->add_option("--accept-fault", options->accepted_faults, help)
      ->allow_extra_args(false)
      ->check(CLI::IsMember(IdsOf(gate::Rules())));
}

// Options of the search for the effect.
void AddSearchOptions(close_loop::Options* options, CLI::App* command) {
  command
      ->add_option_function<std::string>(
          "--by",
          [options](const std::string& what) { options->by_simulation = what == kSimulation; },
          "What a fit compares: the drive's torque with the model's (torque, by default), or the "
          "angle with a simulated one, for free swings and a joint that sticks and slips")
      ->check(CLI::IsMember({"torque", kSimulation}));
  command->add_option("--seed", options->seed, "Seed of the null test's random signs")
      ->capture_default_str();
  AddAcceptFault(options, command,
                 "Continue in spite of this fault of the data (docs/data-gate.md), with `spike` "
                 "also with the rows that stand alone; repeatable");
  command->add_flag("--keep-unconfirmed", options->keep_unconfirmed,
                    "Effects that the held-out recordings neither confirm nor refute go into "
                    "model.yaml, too");
  std::vector<std::string> effects = effects::EffectNames();
  effects.emplace_back(kNoEffect);
  command
      ->add_option_function<std::vector<std::string>>(
          "--effect",
          [options](const std::vector<std::string>& names) {
            options->given.emplace(names.begin(), names.end());
            options->given->erase(kNoEffect);
          },
          "Fit this effect without a search for others; repeatable; \"none\": "
          "the declared terms alone")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(effects));
  command
      ->add_option("--without-rule", options->in_force.without_rules,
                   "Disable a rule (docs/closing-the-loop.md), to measure its effect; repeatable")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(IdsOf(trace::AllRules())));
  command
      ->add_option("--without-effect", options->in_force.without_effects,
                   "Search as though the catalogue did not have this effect; repeatable")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(effects::EffectNames()));
}

struct CheckDataOptions {
  close_loop::Options loop;  // model, map, joint, recordings, accepted faults
  std::filesystem::path out;
  bool json = false;
};

void PrintLines(const gate::GateReport& found) {
  for (const gate::Fault& fault : found.faults) {
    std::cout << "fault " << gate::FormatFault(fault) << '\n';
  }
  for (const gate::Finding& finding : found.findings) {
    std::cout << "finding " << finding.name << ": " << finding.text << '\n';
  }
  std::cout << "verdict: " << report::VerdictWord(found) << '\n';
}

void CheckData(const CheckDataOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const close_loop::Input input = close_loop::LoadInput(options.loop);
  const int number = options.loop.joint.value_or(0);
  const actuator::JointModel& joint = input.model.robot.joints[static_cast<std::size_t>(number)];
  const std::vector<types::Run> runs = close_loop::ReadJoint(options.loop.train, input.map, number);
  if (runs.empty()) throw UsageError("no recording of joint " + joint.name);
  report::Report check{.robot = input.model.robot.name,
                       .joint = joint.name,
                       .model_file = input.model_path.string(),
                       .train = close_loop::Described(runs)};
  try {
    check.gate = close_loop::AskGate(options.loop, runs, joint);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  check.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string json = types::JsonText(report::CheckJson(check), 2) + "\n";
  const std::filesystem::path& out = options.out;
  if (!out.empty()) {
    report::Page page = report::MakeCheckPage(check, report::MakePictures(check.gate, runs, joint));
    page.made = Made();
    const std::string html = report::DrawnHtml(std::move(page));
    std::error_code error;
    std::filesystem::create_directories(out, error);
    if (error) throw UsageError(out.string() + ": " + error.message() + ", expected a folder");
    config::WriteFileAtomically(out / "check.json", json);
    config::WriteFileAtomically(out / "check.html", html);
  }
  if (options.json) {
    std::cout << json;
  } else {
    PrintLines(check.gate);
    if (!out.empty()) std::cout << "written: " << (out / "check.html").string() << ", check.json\n";
  }
  if (check.gate.stops()) throw CLI::RuntimeError(1);
}

}  // namespace

void AddCloseLoopCommand(CLI::App& app) {
  struct Arguments {
    close_loop::Options options;
    std::filesystem::path out;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("close-loop", "Find the effect that a model lacks, from recordings");
  close_loop::Options& options = arguments->options;
  AddModelOptions(&options, command);
  command->add_option("--held-out-map,--sealed-map", options.held_out_map,
                      "Mapping of the held-out CSV files where it is another one");
  AddRecordings(*command, "--train", &options.train,
                "To learn from: CSV, MCAP or a bag of ROS 2, FILE or FILE@START:END (seconds)")
      ->required();
  command->add_option(
      "--held-out,--sealed", options.held_out,
      "Recordings for confirmation, never used for a fit; FILE or FILE@START:END. Without "
      "any, each of several training recordings is held out once");
  command->add_option("--out", arguments->out, "Folder for report.html, report.json and model.yaml")
      ->required();
  command->add_option("--joint", options.joint,
                      "Joint of the model, of an MCAP recording and of the mapping's \"{joint}\", "
                      "from 0 on; all joints of the model when left out");
  command->add_option("--urdf", options.urdf,
                      "Rigid bodies of an arm; what the model file names by default");
  AddSearchOptions(&options, command);
  command->add_flag("--json", arguments->json, "Print the report as JSON");
  command->footer(
      "Fits the declared terms, searches the catalogue (`sinew effects`) for the effects that "
      "explain the\nresidual, adds the confirmed ones and reports the errors before and after. "
      "World and control load\nmodel.yaml unchanged.\n\nExamples:\n"
      "  sinew close-loop train_1.csv train_2.csv --held-out test.csv --out found\n"
      "  sinew close-loop monday.csv tuesday.csv wednesday.csv --out found\n"
      "  sinew close-loop day.csv@:60 --held-out day.csv@60: --out found\n"
      "  sinew close-loop --model robots/emps/model.yaml --map robots/emps/csv_map.yaml \\\n"
      "    DATA_EMPS.csv --held-out DATA_EMPS_PULSES.csv --out found\n"
      "  sinew close-loop --by simulation --model robots/dfki_pendulum/model.yaml \\\n"
      "    energy_shaping_measured.csv@:12 --held-out energy_shaping_measured.csv@12: "
      "--out found\n"
      "  sinew close-loop --model robots/biped/model.yaml run_1.mcap --held-out run_2.mcap "
      "\\\n"
      "    --out found                       # payload and friction of a robot on two feet");
  command->callback([arguments] { Execute(arguments->options, arguments->out, arguments->json); });
}

void AddCheckDataCommand(CLI::App& app) {
  auto options = std::make_shared<CheckDataOptions>();
  CLI::App* command =
      app.add_subcommand("check-data", "Check recordings before a fit: faults and findings");
  close_loop::Options& loop = options->loop;
  command->add_option("recordings", loop.train, "Recordings: CSV, MCAP or bags of ROS 2")
      ->required();
  AddModelOptions(&loop, command);
  command->add_option("--joint", loop.joint,
                      "Joint of the model and of the recordings, from 0 on; 0 by default");
  command->add_option("--out", options->out, "Folder for check.html and check.json");
  AddAcceptFault(&loop, command,
                 "This fault of the data is listed and is no data_fault (docs/data-gate.md); "
                 "repeatable");
  command->add_flag("--json", options->json, "Print check.json");
  command->footer(
      "Prints one line per fault and finding, then the verdict: data_fault or ok. Faults are what "
      "close-loop stops\nat; docs/data-gate.md has the rules and their limits.\n\nExamples:\n"
      "  sinew check-data train_1.csv train_2.csv --out checked\n"
      "  sinew check-data --model robots/emps/model.yaml --map robots/emps/csv_map.yaml "
      "DATA_EMPS.csv");
  command->callback([options] { CheckData(*options); });
}

}  // namespace sinew::tools
