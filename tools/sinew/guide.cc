#include "tools/sinew/guide.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/did_you_mean.h"

namespace sinew::tools {

namespace {

struct Group {
  const char* title;
  std::vector<const char*> commands;
};

// In the order of the help.
const std::array<Group, 5>& Groups() {
  static const std::array<Group, 5> kGroups = {{
      {"Commands to run a robot",
       {"launch", "compose", "arm", "disarm", "estop", "reset", "handover", "permit-replay",
        "conform", "isolate", "enter", "security"}},
      {"Commands to look at it",
       {"list", "echo", "log", "plot", "hz", "graph", "doctor", "view", "score", "performance",
        "render"}},
      {"Commands to record and replay",
       {"record", "replay", "replay-control", "rerun", "snapshot", "import", "export", "recover",
        "attachments"}},
      {"Commands to model",
       {"new", "check-data", "close-loop", "verify", "effects", "model", "train", "tune",
        "experiment", "export-model", "schema"}},
      {"Commands to reproduce what was published",
       {"paper", "tables", "control-test", "squat-test", "compare", "search"}},
  }};
  return kGroups;
}

constexpr char kOther[] = "Other commands";

const CLI::App& InUse(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? app : InUse(*chosen.front());
}

// nullptr: none of that name. App: const or not.
template <class App>
App* Find(App& app, const std::string& name) {
  for (auto* child : app.get_subcommands({})) {
    if (child->get_name() == name) return child;
  }
  return nullptr;
}

std::vector<std::string> WordsOf(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::App* child : command.get_subcommands({})) words.push_back(child->get_name());
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  }
  return words;
}

void PrintHelp(const CLI::App& app, const std::vector<std::string>& path) {
  const CLI::App* command = &app;
  std::string name = app.get_name();
  for (const std::string& word : path) {
    const CLI::App* child = Find(*command, word);
    if (child == nullptr) {
      throw UsageError(name + ": no command '" + word + "'" +
                       types::DidYouMean(word, WordsOf(*command)));
    }
    command = child;
    name += " " + word;
  }
  // App::help() would be that of the command in use, this one.
  std::cout << command->get_formatter()->make_help(command, name, CLI::AppFormatMode::Normal);
}

}  // namespace

void AddGuide(CLI::App& app) {
  auto path = std::make_shared<std::vector<std::string>>();
  CLI::App* help = app.add_subcommand("help", "The help of a command");
  help->add_option("command", *path, "Its name")->type_name("COMMAND");
  help->footer("Example:\n  sinew help model show");
  help->callback([&app, path] { PrintHelp(app, *path); });
  std::vector<CLI::App_p> order;
  for (const Group& group : Groups()) {
    for (const char* name : group.commands) {
      CLI::App* command = Find(app, name);
      if (command == nullptr) continue;  // of reproduction, which may be left out
      command->group(group.title);
      order.push_back(app.get_subcommand_ptr(command));
    }
  }
  for (CLI::App* other : app.get_subcommands({})) {
    if (std::any_of(order.begin(), order.end(), [&](const auto& o) { return o.get() == other; })) {
      continue;
    }
    other->group(kOther);
    order.push_back(app.get_subcommand_ptr(other));
  }
  for (const CLI::App_p& command : order) {
    app.remove_subcommand(command.get());
    app.add_subcommand(command);
  }
}

std::string CommandInUse(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* child : app.get_subcommands()) return name + " " + CommandInUse(*child);
  return name;
}

std::string Suggestion(const CLI::App& app) {
  const std::vector<std::string> unexpected = app.remaining(true);
  if (unexpected.empty()) return "";
  const std::string word = unexpected.front().substr(0, unexpected.front().find('='));
  return types::DidYouMean(word, WordsOf(InUse(app)));
}

}  // namespace sinew::tools
