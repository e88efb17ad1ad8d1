#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/record/logger/player/control_socket.h"
#include "components/record/logger/player/play_control.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

// Beyond what the player takes itself to say that it is waiting (control_socket.cc).
constexpr std::chrono::seconds kPlayerAnswerLimit(10);

// "paused=1 rate=2 ..." as an object; numbers stay numbers.
nlohmann::ordered_json StatusJson(const std::string& words) {
  nlohmann::ordered_json json;
  std::istringstream in(words);
  for (std::string word; in >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) continue;
    const std::string value = word.substr(equals + 1);
    try {
      json[word.substr(0, equals)] = types::ParseJson<nlohmann::ordered_json>(value, "", 0);
    } catch (const std::invalid_argument&) {
      json[word.substr(0, equals)] = value;
    }
  }
  return json;
}

}  // namespace

void AddReplayControlCommand(CLI::App& app) {
  struct Options {
    int domain = 0;
    std::string name;
    std::vector<std::string> request;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("replay-control", "Pause, step or move a running player on this host");
  command->add_option("--domain", options->domain, "The player's DDS domain, 0 to 232")
      ->check(CLI::Range(0, 232))
      ->envname("SINEW_DOMAIN");
  command
      ->add_option("name", options->name,
                   "Its participant name: replay (of sinew replay), player (of sinew-player), or "
                   "what its --name says")
      ->required();
  command
      ->add_option("request", options->request,
                   "pause, resume, toggle, step [TICKS], seek SECONDS, seek +SECONDS, rate TIMES, "
                   "rate max, faster, slower, status, quit")
      ->required();
  command->add_flag("--json", options->json, "The player's state as JSON");
  command->footer(
      "Prints the player's state after the request. A seek begins a new session: receivers see a "
      "state provider\n"
      "that was started again. Exit code 1 when the player refused.\n\nExamples:\n"
      "  sinew replay-control replay pause\n"
      "  sinew replay-control replay step 10\n"
      "  sinew replay-control player seek 12.5\n"
      "  sinew replay-control player rate max --json");
  command->callback([options] {
    const std::string line = types::Joined(options->request, " ");
    try {
      (void)logger::ParsePlayRequest(line);
    } catch (const std::invalid_argument& error) {
      throw UsageError(std::string("sinew replay-control: ") + error.what());
    }
    const std::string answer = logger::AskPlayer(
        logger::PlayerSocket(options->domain, options->name), line, kPlayerAnswerLimit);
    const std::size_t blank = answer.find(' ');
    const std::string rest = blank == std::string::npos ? "" : answer.substr(blank + 1);
    if (answer.substr(0, blank) != "ok") {
      std::cerr << "sinew replay-control: " << rest << '\n';
      throw CLI::RuntimeError(1);
    }
    std::cout << (options->json ? types::JsonText(StatusJson(rest)) : rest) << '\n';
  });
}

}  // namespace sinew::tools
