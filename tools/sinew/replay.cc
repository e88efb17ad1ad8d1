#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "components/base/types/json_text.h"
#include "components/base/types/text.h"
#include "components/record/logger/player/participant/play.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/replay_screen.h"
#include "tools/sinew/terminal_keys.h"

namespace sinew::tools {

namespace {

// The keys and the line, each only where there is a terminal.
class ReplayScreen {
 public:
  explicit ReplayScreen(logger::PlayControl& control)
      : visible_(::isatty(STDERR_FILENO) == 1), keys_([this, &control](char byte) {
          const std::optional<std::string> request = decoder_.Take(byte);
          if (request) control.Post(logger::ParsePlayRequest(*request));
        }) {}
  ~ReplayScreen() { Finish(); }
  ReplayScreen(const ReplayScreen&) = delete;
  ReplayScreen& operator=(const ReplayScreen&) = delete;

  void Show(const logger::PlayStatus& status) {
    if (!visible_) return;
    const auto columns = static_cast<std::size_t>(SizeOfTerminal(STDERR_FILENO).columns);
    Unfiltered(std::cerr) << "\r\x1b[K" << ReplayLine(status, columns - 1) << std::flush;
    drawn_ = true;
  }
  void Finish() {
    if (drawn_) Unfiltered(std::cerr) << "\r\x1b[K" << std::flush;
    drawn_ = false;
  }

 private:
  const bool visible_;
  bool drawn_ = false;
  KeyDecoder decoder_;  // of the keys' thread
  TerminalKeys keys_;
};

}  // namespace

void AddReplayCommand(CLI::App& app) {
  struct Options {
    node::Options node;
    logger::PlayOptions play;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("replay", "Send the topics of a recording into a domain");
  AddNodeOptions(*command, &options->node);
  command
      ->add_option("--name", options->node.name,
                   "Participant name, by which replay-control reaches it")
      ->capture_default_str();
  logger::AddPlayOptions(*command, &options->play);
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "Messages are marked as replay: live hardware moves by none of them but a reference that an "
      "operator\n"
      "permits (sinew permit-replay). With joint_state among "
      "the topics\n"
      "replay is the state provider; without it, it can stand in for others (--follow). In "
      "lockstep nothing\n"
      "is lost, and it runs as fast as the readers take it. Keys on a terminal: space pauses, s "
      "steps a tick, left\n"
      "and right seek 5 s, down and up 60 s, + and - change the rate, q ends; from elsewhere: "
      "sinew replay-control.\n"
      "A seek and each loop begin a new session.\n\nExamples:\n"
      "  sinew replay run.mcap --rate 2 --loop 0\n"
      "  sinew replay run.mcap --rate max --topics '.*_state' --exclude reservoir_state\n"
      "  sinew replay run.mcap --paused --name bench\n"
      "  sinew replay run.mcap --lockstep --wait-readers 1\n"
      "  sinew replay run.mcap --topics reference --follow");
  command->callback([options] {
    node::StopFlag stop;
    node::Node node(options->node);
    logger::PlayControl control;
    ReplayScreen screen(control);
    const logger::PlayResult result =
        logger::Play(node, stop, options->play, control,
                     [&screen](const logger::PlayResult& now) { screen.Show(now.status); });
    screen.Finish();
    if (options->json) {
      std::cout << types::JsonText(nlohmann::ordered_json{{"file", options->play.path.string()},
                                                          {"messages", result.messages},
                                                          {"of", result.message_count},
                                                          {"write_failures", result.write_failures},
                                                          {"recorded_s", result.recorded_s},
                                                          {"wall_s", result.wall_s}})
                << '\n';
    } else {
      std::cout << options->play.path.string() << ": " << result.messages << " of "
                << result.message_count << " messages, "
                << types::Text("%.1f s in %.1f s", result.recorded_s, result.wall_s) << '\n';
    }
    if (result.write_failures > 0) {
      std::cerr << "sinew replay: " << result.write_failures << " messages could not be sent\n";
      throw CLI::RuntimeError(1);
    }
  });
}

}  // namespace sinew::tools
