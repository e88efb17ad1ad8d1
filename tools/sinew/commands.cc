#include "tools/sinew/commands.h"

#include "tools/sinew/completion.h"
#include "tools/sinew/effects.h"
#include "tools/sinew/launch.h"
#include "tools/sinew/model.h"
#include "tools/sinew/operator.h"
#include "tools/sinew/score.h"

namespace sinew::tools {

void AddAllCommands(CLI::App& app) {
  AddLaunchCommand(app);
  AddOperatorCommands(app);
  AddEffectsCommand(app);
  AddModelCommand(app);
  AddScoreCommand(app);
  AddCompletionCommand(app);
}

}  // namespace sinew::tools
