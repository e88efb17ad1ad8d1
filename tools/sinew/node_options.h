// Options of the commands that join a DDS domain.
#pragma once

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <string>

#include "components/topics/node/log.h"
#include "components/topics/node/options.h"

namespace sinew::tools {

// Warnings and errors of the libraries, as lines of this command.
inline void StartCommandLog(const std::string& name) {
  auto logger = spdlog::get(name);
  if (!logger) logger = spdlog::stderr_color_mt(name);
  logger->set_level(spdlog::level::warn);
  spdlog::set_default_logger(logger);
  node::internal::SetLogPattern("sinew %n: ");
}

// The options of node::AddDomainOptions and --lockstep; once they are read, the deployment is
// entered and the command has its log. The component is the command's name.
inline void AddNodeOptions(CLI::App& command, node::Options* options) {
  options->component = command.get_name();
  options->name = command.get_name();
  node::AddDomainOptions(command, options);
  command.add_flag_callback(
      "--lockstep", [options] { options->mode = node::TimeMode::kLockstep; },
      "The deployment runs in lockstep");
  command.parse_complete_callback([options, name = command.get_name()] {
    node::EnterDeployment(*options);
    StartCommandLog(name);
  });
}

}  // namespace sinew::tools
