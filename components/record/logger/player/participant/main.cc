// The player: a recording's topics into a domain, as a stand-in for their writers.
#include <spdlog/spdlog.h>

#include "components/record/logger/player/participant/play.h"

int main(int argc, char** argv) {
  sinew::logger::PlayOptions play;
  const auto body = [&play](const sinew::node::Options& options, sinew::node::StopFlag& stop) {
    if (!options.config_path.empty()) {
      throw sinew::UsageError(
          "--config: the player has no configuration file, expected options only");
    }
    sinew::node::Node node(options);
    sinew::logger::PlayControl control;
    const sinew::logger::PlayResult result = sinew::logger::Play(node, stop, play, control);
    spdlog::info("{} of {} messages, {:.1f} s of recording in {:.1f} s, {} writes failed",
                 result.messages, result.message_count, result.recorded_s, result.wall_s,
                 result.write_failures);
  };
  return sinew::node::RunParticipant(
      argc, argv, "player", "Sends the topics of an MCAP recording", body,
      [&play](CLI::App& app) { sinew::logger::AddPlayOptions(app, &play); });
}
