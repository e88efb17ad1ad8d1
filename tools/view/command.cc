#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/node/options.h"
#include "tools/launch/find_program.h"
#include "tools/sinew/node_options.h"
#include "tools/view/view_config.h"

namespace sinew::live {

namespace {

struct ViewCommandOptions {
  node::Options node;
  ViewOptions view;
};

// This process becomes sinew-view: signals and exit code are its own.
[[noreturn]] void Become(const ViewCommandOptions& options) {
  const std::filesystem::path folder = launch::ProgramFolder();
  const std::filesystem::path program =
      launch::FindProgram("sinew-view", std::filesystem::current_path(), folder);
  if (program.empty()) throw UsageError(launch::NoProgram("sinew-view", folder));
  std::vector<std::string> line = {program.string(), "--domain",
                                   std::to_string(options.node.domain_id)};
  for (const std::string& name : options.node.interfaces) {
    line.insert(line.end(), {"--interface", name});
  }
  for (const std::string& name : options.node.open_interfaces) {
    line.insert(line.end(), {"--open", name});
  }
  if (options.node.mode == node::TimeMode::kLockstep) line.push_back("--lockstep");
  const auto add_path = [&line](const char* name, const std::filesystem::path& path) {
    if (!path.empty()) line.insert(line.end(), {name, path.string()});
  };
  add_path("--deployment", options.node.deployment);
  add_path("--qos", options.node.qos_path);
  add_path("--key", options.node.key_path);
  add_path("--config", options.node.config_path);
  const std::vector<std::string> words = WordsOf(options.view);
  line.insert(line.end(), words.begin(), words.end());
  std::vector<char*> pointers;
  pointers.reserve(line.size() + 1);
  for (std::string& word : line) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  ::execv(pointers[0], pointers.data());
  throw std::runtime_error(line[0] + ": " + std::strerror(errno));
}

}  // namespace

void AddViewCommand(CLI::App& app) {
  auto options = std::make_shared<ViewCommandOptions>();
  CLI::App* command =
      app.add_subcommand("view", "A live page of the robot, or of a recording, for a browser");
  tools::AddNodeOptions(*command, &options->node);
  command->parse_complete_callback({});  // sinew-view enters the deployment itself
  command->add_option("--config", options->node.config_path,
                      "Configuration of the page, such as robots/rig/view.yaml");
  AddViewOptions(*command, &options->view);
  command->footer(
      "Prints the address of the page; Foxglove and Lichtblick connect to the same port (ws://).\n"
      "Estop and disarm are always on the page, arm and reset with --allow-arming. The page reads\n"
      "only: when it goes away, nothing changes.\n\nExamples:\n"
      "  sinew view --config robots/rig/view.yaml\n"
      "  sinew view --config robots/biped/view.yaml --lockstep\n"
      "  sinew view run.mcap --urdf robots/rig/rig.urdf");
  command->callback([options] { Become(*options); });
}

}  // namespace sinew::live
