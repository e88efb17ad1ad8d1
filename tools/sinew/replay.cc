#include "tools/sinew/replay.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/logger/player/participant/play.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/progress.h"

namespace sinew::tools {

void AddReplayCommand(CLI::App& app) {
  struct Options {
    node::Options node;
    logger::PlayOptions play;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("replay", "Send the topics of a recording into a domain");
  AddNodeOptions(*command, &options->node);
  logger::AddPlayOptions(*command, &options->play);
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "Messages are marked as replay: live hardware moves by none of them but a reference that an "
      "operator\n"
      "permits (sinew permit-replay). With joint_state among "
      "the topics\n"
      "replay is the state provider; without it, it can stand in for others (--follow). In "
      "lockstep nothing\n"
      "is lost, and it runs as fast as the readers take it.\n\nExamples:\n"
      "  sinew replay run.mcap --rate 2\n"
      "  sinew replay run.mcap --lockstep --wait-readers 1\n"
      "  sinew replay run.mcap --topics reference --follow");
  command->callback([options] {
    node::StopFlag stop;
    StartCommandLog("replay");
    node::Node node(options->node);
    ProgressBar bar("replay", "messages", 0);
    const logger::PlayResult result = logger::Play(
        node, stop, options->play,
        [&bar](const logger::PlayResult& now) { bar.Update(now.messages, now.message_count); });
    bar.Finish();
    if (options->json) {
      std::cout << nlohmann::ordered_json{{"file", options->play.path.string()},
                                          {"messages", result.messages},
                                          {"of", result.message_count},
                                          {"write_failures", result.write_failures},
                                          {"recorded_s", result.recorded_s},
                                          {"wall_s", result.wall_s}}
                       .dump()
                << '\n';
    } else {
      char times[64];
      std::snprintf(times, sizeof(times), "%.1f s in %.1f s", result.recorded_s, result.wall_s);
      std::cout << options->play.path.string() << ": " << result.messages << " of "
                << result.message_count << " messages, " << times << '\n';
    }
    if (result.write_failures > 0) {
      std::cerr << "sinew replay: " << result.write_failures << " messages could not be sent\n";
      throw CLI::RuntimeError(1);
    }
  });
}

}  // namespace sinew::tools
