// `sinew attachments`: the files that a recording carries.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddAttachmentsCommand(CLI::App& app);

}  // namespace sinew::tools
