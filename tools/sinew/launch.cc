#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "components/base/types/json_text.h"
#include "components/robot/provider/participant/other_provider.h"
#include "components/topics/node/node.h"
#include "tools/launch/deployment.h"
#include "tools/launch/launcher.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace {

struct LaunchOptions {
  std::string file;
  launch::Overrides overrides;
  std::string record;
  std::optional<std::string> seed, duration, domain, mode;
  bool dry_run = false;
  bool json = false;
};

std::string Quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-+=./:,@%") == std::string::npos;
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::filesystem::path OrOfEnvironment(const std::filesystem::path& given, const char* variable) {
  const char* value = std::getenv(variable);
  return given.empty() && value != nullptr ? std::filesystem::path(value) : given;
}

void PrintPlan(const launch::Deployment& deployment, bool json) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const launch::Process& process : deployment.processes) {
    const std::vector<std::string> line = launch::CommandLine(deployment, process);
    list.push_back({{"name", process.name}, {"command", line}, {"after", process.after}});
    if (!process.host.empty()) list.back()["host"] = process.host;
    if (json) continue;
    std::cout << process.name << ":";
    for (const std::string& word : line) std::cout << ' ' << Quoted(word);
    std::cout << '\n';
  }
  for (const launch::Process& process : deployment.elsewhere) {
    list.push_back({{"name", process.name}, {"host", process.host}});
    if (!json) std::cout << process.name << ": on host " << process.host << '\n';
  }
  if (!json) return;
  const nlohmann::ordered_json plan = {{"name", deployment.name},
                                       {"domain_id", deployment.domain_id},
                                       {"mode", deployment.lockstep ? "lockstep" : "realtime"},
                                       {"duration_s", deployment.duration_s},
                                       {"seed", deployment.seed},
                                       {"provider", deployment.provider},
                                       {"processes", list}};
  std::cout << types::JsonText(plan, 2) << '\n';
}

std::string Summary(const launch::Deployment& deployment, const launch::Result& result) {
  std::ostringstream text;
  text.precision(1);
  text << std::fixed << deployment.name
       << (deployment.host.empty() ? "" : " on host " + deployment.host) << ": "
       << deployment.processes.size() << " processes, " << result.duration_s << " s, "
       << result.restarts << " restarts, ";
  if (result.ok()) {
    text << (result.stopped_by_user ? "stopped as asked" : "all ended well");
  } else {
    text << "FAILED";
  }
  return text.str();
}

void PrintResult(const launch::Deployment& deployment, const launch::Result& result, bool json,
                 launch::Output* output) {
  for (const launch::Failure& failure : result.failures) {
    std::string text = failure.process + ": " + failure.cause;
    if (!failure.last_lines.empty()) text += "; its last lines:";
    output->Say(text);
    for (const std::string& line : failure.last_lines) std::cerr << "    " << line << '\n';
  }
  output->Say(Summary(deployment, result));
  if (!json) return;
  nlohmann::ordered_json failures = nlohmann::ordered_json::array();
  for (const launch::Failure& failure : result.failures) {
    failures.push_back({{"process", failure.process},
                        {"cause", failure.cause},
                        {"last_lines", failure.last_lines}});
  }
  const nlohmann::ordered_json report = {{"name", deployment.name},
                                         {"ok", result.ok()},
                                         {"duration_s", result.duration_s},
                                         {"restarts", result.restarts},
                                         {"stopped_by_user", result.stopped_by_user},
                                         {"failures", failures}};
  std::cout << types::JsonText(report, 2) << std::endl;
}

// A deployment whose state provider would be refused starts nothing beside the robot that runs.
// Throws UsageError: there is one. False: a stop was asked for.
bool LookFirst(const launch::Deployment& deployment) {
  // Newcomers are answered at once; the provider itself looks for longer.
  constexpr std::chrono::milliseconds kLook{600};
  if (deployment.provider.empty() || deployment.isolated || deployment.provider_elsewhere()) {
    return true;
  }
  const node::StopFlag stop;
  node::Options options;
  options.component = options.name = "launch";
  options.domain_id = deployment.domain_id;
  options.interfaces = deployment.interfaces;
  options.open_interfaces = deployment.open;
  options.qos_path = OrOfEnvironment(
      launch::QosOf(deployment, deployment.Find(deployment.provider)->certificate), "SINEW_QOS");
  options.key_path = OrOfEnvironment(deployment.key, "SINEW_KEY");
  if (deployment.lockstep) options.mode = node::TimeMode::kLockstep;
  node::Node node(options);
  provider::OtherProvider(node).Refuse(kLook, stop);
  return !stop.requested();
}

void RunLaunch(LaunchOptions options) {
  auto& settings = options.overrides.settings;
  const auto add = [&settings](const char* key, const std::optional<std::string>& value) {
    if (value) settings.push_back(std::string(key) + "=" + *value);
  };
  add("mode", options.mode);
  add("seed", options.seed);
  add("duration_s", options.duration);
  add("domain_id", options.domain);
  options.overrides.record = options.record;
  const launch::Deployment deployment = launch::LoadDeployment(options.file, options.overrides);
  if (options.dry_run) {
    PrintPlan(deployment, options.json);
    return;
  }
  launch::CheckCertificates(deployment);
  for (const launch::Host& host : deployment.hosts) {
    if (host.name == deployment.host) launch::RequireUser(host, deployment.file);
  }
  // Fast DDS' own variable, for this process and those that it starts.
  if (!deployment.discovery_server.empty()) {
    ::setenv("ROS_DISCOVERY_SERVER", deployment.discovery_server.c_str(), 1);
  }
  if (!LookFirst(deployment)) return;
  std::vector<std::string> names;
  for (const launch::Process& process : deployment.processes) names.push_back(process.name);
  // With --json the standard output is the report alone.
  std::ostream& lines = options.json ? std::cerr : std::cout;
  const int descriptor = options.json ? STDERR_FILENO : STDOUT_FILENO;
  launch::Output output(Unfiltered(lines), Unfiltered(std::cerr), launch::WantsColour(descriptor),
                        names);
  const launch::Result result = launch::RunDeployment(deployment, output);
  PrintResult(deployment, result, options.json, &output);
  if (!result.ok()) throw CLI::RuntimeError(1);
}

void AddDeploymentOptions(CLI::App& command, LaunchOptions* options) {
  command.add_option("file", options->file, "Deployment (schema sinew-deployment/1)")
      ->required()
      ->type_name("FILE.yaml");
  command.add_option("--mode", options->mode, "Time: on the wall clock, or as fast as it goes")
      ->check(CLI::IsMember({"realtime", "lockstep"}));
  command.add_option("--duration", options->duration, "Length of the session in s, 0: no end")
      ->type_name("SECONDS");
  command.add_option("--seed", options->seed, "Seed of everything random")->type_name("NUMBER");
  command.add_option("--domain", options->domain, "DDS domain, 0 to 232")
      ->envname("SINEW_DOMAIN")
      ->type_name("NUMBER");
  command
      .add_option("--host", options->overrides.host,
                  "Whose part of a deployment over several hosts is started, by default this "
                  "machine's by its name; all: every process on this machine, on loopback")
      ->type_name("NAME");
  command.add_flag("--isolate", options->overrides.isolate,
                   "In a network of its own, which nobody else can send to");
  command.add_option("--record", options->record, "Record to this file (adds a logger if needed)")
      ->type_name("FILE.mcap");
  command.add_flag("--overwrite", options->overrides.overwrite,
                   "Replace recordings that are there already: every logger's");
  command
      .add_option(
          "--set", options->overrides.settings,
          "Override a key: mode, duration_s, seed, domain_id, interfaces, realtime_priority, "
          "grace_s, "
          "PROCESS.config, PROCESS.program, PROCESS.restart")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->expected(1);
  command.add_option("--arg", options->overrides.arguments, "Add an argument to a process")
      ->type_name("PROCESS=ARGUMENT")
      ->take_all()
      ->expected(1);
  command
      .add_option("--without", options->overrides.without,
                  "Leave a process out, and what only it is awaited for")
      ->type_name("PROCESS")
      ->take_all()
      ->expected(1);
  command.add_flag("--dry-run", options->dry_run, "Print the command lines and start nothing");
  command.add_flag("--json", options->json,
                   "Report as JSON on the standard output; lines of processes go to stderr");
  command
      .add_option("--compose", options->overrides.compose,
                  "Processes that run in the provider's thread, comma-separated")
      ->type_name("PROCESS,...")
      ->delimiter(',');
}

}  // namespace

void AddLaunchCommand(CLI::App& app) {
  auto options = std::make_shared<LaunchOptions>();
  CLI::App* command = app.add_subcommand("launch", "Start the processes of a deployment file");
  AddDeploymentOptions(*command, options.get());
  command->footer(
      "Ctrl-C stops all: the provider first, the logger last; a second one hurries.\n"
      "Exit code 1 when a process failed, with its cause and last lines.\n\n"
      "Examples:\n"
      "  sinew launch robots/rig/deploy_rig.yaml\n"
      "  sinew launch robots/rig/deploy_rig.yaml --mode lockstep --duration 60 --seed 7 "
      "--record run.mcap\n"
      "  sinew launch robots/rig/deploy_rig.yaml --arg surrogate=--effect --arg "
      "surrogate=stribeck\n"
      "  sinew launch robots/rig/deploy_rig.yaml --set control.config=robots/rig/control_pid.yaml");
  command->callback([options] { RunLaunch(*options); });
}

void AddComposeCommand(CLI::App& app) {
  auto options = std::make_shared<LaunchOptions>();
  CLI::App* command = app.add_subcommand(
      "compose", "As launch, with the provider and its chain as one process with one thread");
  AddDeploymentOptions(*command, options.get());
  command->footer(
      "Without --compose: the processes of the deployment that are sinew-reference, sinew-regime, "
      "sinew-esn,\nsinew-control, sinew-pneumatics or sinew-rls. The others start as ever. Topics "
      "are the same;\na participant that is composed is still handed over to another process.\n\n"
      "Examples:\n"
      "  sinew compose robots/rig/deploy_esn.yaml --duration 14\n"
      "  sinew compose robots/rig/deploy_esn.yaml --compose reference,control --dry-run");
  command->callback([options] {
    options->overrides.compose_all = options->overrides.compose.empty();
    RunLaunch(*options);
  });
}

}  // namespace sinew::tools
