// Options of sinew-view, and its configuration, schema sinew-view/1 (docs/participants/view.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/fields.h"

namespace CLI {
class App;
}

namespace sinew::live {

inline constexpr unsigned short kDefaultPort = 8765;  // where Foxglove looks first

struct ViewOptions {
  std::string address = "127.0.0.1";
  int port = -1;                    // -1: of the configuration, else kDefaultPort
  int listener = -1;                // of Listen(); not of the command line
  std::filesystem::path urdf;       // empty: of the configuration, else no robot is drawn
  std::filesystem::path recording;  // empty: live
  std::filesystem::path record_folder = ".";
  std::vector<std::string> signals;  // plotted at first, "joint_state.position_rad[0]"
  std::vector<std::string> sockets;  // of an estop; empty: those that are found
  bool allow_arming = false;
};

void AddViewOptions(CLI::App& app, ViewOptions* options);
// The words of a command line that AddViewOptions reads as these options.
std::vector<std::string> WordsOf(const ViewOptions& options);

inline constexpr char kSchema[] = "sinew-view/1";

struct ViewFile {
  std::optional<std::filesystem::path> urdf;
  int port = kDefaultPort;
  std::vector<std::string> signals;
};
void Describe(config::Fields& f, ViewFile& c);

// Adds the file's values to options that were not given. Throws UsageError.
ViewOptions WithConfiguration(ViewOptions options, const std::filesystem::path& file);

}  // namespace sinew::live
