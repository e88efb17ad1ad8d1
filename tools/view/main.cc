// sinew-view: a live page of the robot, and its topics for Foxglove and Lichtblick, on one port.
#include <filesystem>
#include <optional>

#include "components/base/config/config.h"
#include "components/topics/node/options.h"
#include "tools/sinew/shipped.h"
#include "tools/view/live_view.h"
#include "tools/view/page.h"
#include "tools/view/robot.h"
#include "tools/view/view_config.h"

namespace {

using namespace sinew;

void Run(const node::Options& options, node::StopFlag& stop, const live::ViewOptions& given) {
  const live::ViewOptions view = live::WithConfiguration(given, options.config_path);
  const std::filesystem::path folder = tools::ShippedFolder("tools/view/page");
  if (folder.empty()) {
    throw UsageError(
        "the page's files are not beside the program, expected share/sinew/tools/view/page");
  }
  const live::Page page(folder);
  std::optional<live::Robot> robot;
  if (!view.urdf.empty()) robot.emplace(view.urdf);
  (view.recording.empty() ? live::RunLive : live::RunRecorded)(options, stop, view, page,
                                                               robot ? &*robot : nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  live::ViewOptions view;
  return node::RunParticipant(
      argc, argv, "view", "Serves a live page of the robot, and its topics for Foxglove.",
      [&](const node::Options& options, node::StopFlag& stop) { Run(options, stop, view); },
      [&](CLI::App& app) { live::AddViewOptions(app, &view); });
}
