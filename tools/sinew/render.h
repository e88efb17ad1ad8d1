// `sinew render`: a recording as a video.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddRenderCommand(CLI::App& app);

}  // namespace sinew::tools
