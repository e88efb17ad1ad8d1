#include "tools/conform/conform.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "tools/launch/find_program.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"

namespace sinew::tools {

namespace {

struct ConformOptions {
  conform::Options options;
  std::string program;
  bool real_time_only = false;
  bool json = false;
};

void RunConformCommand(const ConformOptions& given) {
  conform::Options options = given.options;
  const auto folder = launch::ProgramFolder();
  options.program = launch::FindProgram(given.program, std::filesystem::current_path(), folder);
  if (options.program.empty()) throw UsageError(launch::NoProgram(given.program, folder));
  options.lockstep = !given.real_time_only;
  const conform::Report report = conform::RunConform(options);
  if (given.json) {
    std::cout << types::JsonText(conform::ToJson(report), 2) << '\n';
  } else {
    conform::Print(report, std::cout);
  }
  if (!report.passed()) throw CLI::RuntimeError(1);
}

}  // namespace

void AddConformCommand(CLI::App& app) {
  auto given = std::make_shared<ConformOptions>();
  CLI::App* command = app.add_subcommand(
      "conform", "Check that a program keeps the contract of the role that it takes");
  command->add_option("role", given->options.role, "What it stands in for, e.g. control")
      ->required();
  command->add_option("program", given->program, "Path, or a name beside sinew or in PATH")
      ->required();
  command->add_option("arguments", given->options.arguments, "Its own arguments, after --");
  command->add_option("--domain", given->options.domain_id, "DDS domain in which nobody else is")
      ->check(CLI::Range(0, 232))
      ->capture_default_str();
  command->add_option("--rate", given->options.rate_Hz, "Ticks a second")
      ->check(CLI::Range(1.0, 2000.0))
      ->capture_default_str();
  command->add_option("--joints", given->options.joints, "Of the robot that is played")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  command->add_flag("--real-time-only", given->real_time_only,
                    "The program knows no lockstep: those checks are not applicable");
  command->add_option("--only", given->options.only, "Names of checks: these alone")
      ->delimiter(',');
  command->add_flag("--json", given->json, "As JSON");
  command->footer(
      "Exit code 1 when a check failed. What each check means: docs/how-to/conform.md.\n\n"
      "Example:\n  sinew conform control sinew-control -- --config "
      "robots/rig/control_pid_model.yaml");
  command->callback([given] {
    StartCommandLog("conform");
    RunConformCommand(*given);
  });
}

}  // namespace sinew::tools
