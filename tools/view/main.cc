// sinew-view: a live page of the robot, and its topics for Foxglove and Lichtblick, on one port.
#include <filesystem>
#include <optional>

#include "components/base/config/config.h"
#include "components/topics/node/options.h"
#include "tools/sinew/shipped.h"
#include "tools/view/live_view.h"
#include "tools/view/page.h"
#include "tools/view/robot.h"
#include "tools/view/server.h"
#include "tools/view/view_config.h"

namespace {

using namespace sinew;

void Run(const node::Options& options, node::StopFlag& stop, const live::ViewOptions& view) {
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
      [&](CLI::App& app) { live::AddViewOptions(app, &view); },
      // Browsers are on the host, also where the robot is isolated.
      [&](const node::Options& options) {
        view = live::WithConfiguration(view, options.config_path);
        view.listener = live::Listen(view.address, static_cast<unsigned short>(view.port));
      });
}
