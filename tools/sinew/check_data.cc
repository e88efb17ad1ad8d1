#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/close_loop/input.h"
#include "components/model/report/file/report_file.h"
#include "components/model/report/file/section_file.h"
#include "tools/sinew/close_loop.h"
#include "tools/sinew/core_commands.h"
#include "tools/sinew/shipped.h"

namespace sinew::tools {

namespace {

struct CheckDataOptions {
  close_loop::Options loop;  // model, map, joint, recordings, accepted faults
  std::filesystem::path out;
  bool json = false;
};

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
    const std::string html = report::DrawnHtml(
        report::MakeCheckPage(check, report::MakePictures(check.gate, runs, joint)));
    std::error_code error;
    std::filesystem::create_directories(out, error);
    if (error) throw UsageError(out.string() + ": " + error.message() + ", expected a folder");
    config::WriteFileAtomically(out / "check.json", json);
    config::WriteFileAtomically(out / "check.html", html);
  }
  if (options.json) {
    std::cout << json;
    return;
  }
  for (const gate::Fault& fault : check.gate.faults) {
    std::cout << "fault " << gate::FormatFault(fault) << '\n';
  }
  for (const gate::Finding& finding : check.gate.findings) {
    std::cout << "finding " << finding.name << ": " << finding.text << '\n';
  }
  std::cout << "verdict: " << report::VerdictWord(check.gate) << '\n';
  if (!out.empty()) std::cout << "written: " << (out / "check.html").string() << ", check.json\n";
}

}  // namespace

void AddCheckDataCommand(CLI::App& app) {
  auto options = std::make_shared<CheckDataOptions>();
  CLI::App* command =
      app.add_subcommand("check-data", "Check recordings before a fit: faults and findings");
  close_loop::Options& loop = options->loop;
  loop.rig = RobotsFolder() / "rig";
  command->add_option("recordings", loop.train, "Recordings: CSV, MCAP or bags of ROS 2")
      ->required();
  command->add_option(
      "--model", loop.model,
      "Model file (sinew-model/1) or a laboratory's rig.json; the rig's by default");
  command->add_option("--map", loop.map,
                      "Mapping of CSV columns (sinew-csv-map/1); csv_map.yaml beside the model by "
                      "default, else the rig's");
  command->add_option("--joint", loop.joint,
                      "Joint of the model and of the recordings, from 0 on; 0 by default");
  command->add_option("--out", options->out, "Folder for check.html and check.json");
  command
      ->add_option("--accept-fault", loop.accepted_faults,
                   "This fault of the data is listed and is no data_fault (docs/data-gate.md); "
                   "repeatable")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(FaultNames()));
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
