// The `sinew` command: one subcommand per file, listed here.
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/topics/node/log.h"
#include "components/topics/node/topics.h"
#include "components/topics/node/version.h"
#include "tools/sinew/candidates.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/guide.h"
#include "tools/sinew/printed.h"

namespace {

void AddVersionCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("version", "Print the version");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "As JSON");
  command->callback([json] {
    const std::string version = sinew::node::kVersion, topics = sinew::node::AllTopicsHash();
    if (*json) {
      std::cout << sinew::types::JsonText(
                       nlohmann::json{{"version", version}, {"topics_hash", topics}})
                << '\n';
    } else {
      std::cout << "sinew " << version << ", topics " << topics << '\n';
    }
  });
}

std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

int main(int argc, char** argv) {
  const sinew::tools::PrintableOnly out(std::cout), error_out(std::cerr);
  sinew::node::internal::SetLogPattern("[%Y-%m-%d %H:%M:%S.%e] [%^%l%$] ");  // as spdlog has it
  CLI::App app("Distributed components for robots with SEA-PEA actuators", "sinew");
  try {
    app.set_version_flag("--version", std::string("sinew ") + sinew::node::kVersion);
    app.require_subcommand(0, 1);
    app.footer(
        "The help of each command has examples, e.g. `sinew help launch`. Exit codes: 0 done, 1 a "
        "fault was found\nor the robot did not do it, 2 error.");
    sinew::tools::AddAllCommands(app);
    AddVersionCommand(app);
    sinew::tools::AddGuide(app);
    if (argc > 1 && argv[1] == std::string(sinew::tools::kComplete)) {
      sinew::tools::PrintCandidates(app, {argv + 2, argv + argc});
      return EXIT_SUCCESS;
    }
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      std::cerr << app.help();
      return 2;
    }
    return EXIT_SUCCESS;
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::RuntimeError& error) {  // the command has said why
    return error.get_exit_code();
  } catch (const CLI::Error& error) {
    const std::string command = sinew::tools::CommandInUse(app);
    std::cerr << command << ": " << FirstLine(error.what()) << sinew::tools::Suggestion(app)
              << (command == app.get_name() ? "; see sinew help" : "; see " + command + " --help")
              << '\n';
    return 2;
  } catch (const sinew::UsageError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << sinew::tools::CommandInUse(app) << ": " << error.what() << '\n';
    return 2;
  }
}
