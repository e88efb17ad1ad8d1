#include "tools/view/view_config.h"

#include <CLI/CLI.hpp>

#include "components/base/config/config.h"

namespace sinew::live {

namespace {

constexpr double kLargestPort = 65535.0;

}  // namespace

void AddViewOptions(CLI::App& app, ViewOptions* options) {
  app.add_option("recording", options->recording, "Show this MCAP file instead of a domain");
  app.add_option("--urdf", options->urdf, "The robot to draw; of the configuration by default");
  app.add_option("--port", options->port, "Of the page; 0: any that is free; 8765 by default")
      ->check(CLI::Range(0, static_cast<int>(kLargestPort)));
  app.add_option("--address", options->address,
                 "IPv4 address of this host to listen on; another one than loopback lets other "
                 "hosts read")
      ->capture_default_str();
  app.add_option("--signal", options->signals,
                 "Plotted at first, such as joint_state.velocity_rad_s[0]; may be repeated")
      ->type_name("TOPIC.FIELD")
      ->allow_extra_args(false);
  app.add_option("--record-folder", options->record_folder,
                 "Where the page's recordings are written")
      ->capture_default_str();
  app.add_flag("--allow-arming", options->allow_arming, "The page may arm and reset the robot");
  app.add_option("--estop-socket", options->sockets,
                 "Socket of a state provider on this host; those of the domain by default")
      ->allow_extra_args(false);
}

std::vector<std::string> WordsOf(const ViewOptions& options) {
  std::vector<std::string> words = {"--address", options.address, "--record-folder",
                                    options.record_folder.string()};
  const auto add = [&words](const char* name, const std::string& value) {
    words.insert(words.end(), {name, value});
  };
  if (options.port >= 0) add("--port", std::to_string(options.port));
  if (!options.urdf.empty()) add("--urdf", options.urdf.string());
  for (const std::string& signal : options.signals) add("--signal", signal);
  for (const std::string& socket : options.sockets) add("--estop-socket", socket);
  if (options.allow_arming) words.push_back("--allow-arming");
  if (!options.recording.empty()) words.push_back(options.recording.string());
  return words;
}

void Describe(config::Fields& f, ViewFile& c) {
  f("urdf", c.urdf, "the robot to draw");
  f("port", c.port, {0.0, kLargestPort}, "of the page");
  f("signals", c.signals, "plotted at first, such as joint_state.position_rad[0]");
}

ViewOptions WithConfiguration(ViewOptions options, const std::filesystem::path& file) {
  ViewFile from_file;
  if (!file.empty()) from_file = config::Read<ViewFile>(config::Section::Load(file, kSchema));
  if (options.urdf.empty()) options.urdf = from_file.urdf.value_or("");
  if (options.signals.empty()) options.signals = from_file.signals;
  if (options.port < 0) options.port = from_file.port;
  return options;
}

}  // namespace sinew::live
