#include "tools/sinew/commands.h"

#include "tools/sinew/completion.h"
#include "tools/sinew/launch.h"
#include "tools/sinew/operator.h"
#ifdef SINEW_HAVE_EFFECTS
#include "tools/sinew/effects.h"
#endif
#ifdef SINEW_HAVE_TRAIN
#include "tools/sinew/train.h"
#endif

namespace sinew::tools {

void AddAllCommands(CLI::App& app) {
  AddLaunchCommand(app);
  AddOperatorCommands(app);
#ifdef SINEW_HAVE_EFFECTS
  AddEffectsCommand(app);
#endif
#ifdef SINEW_HAVE_TRAIN
  AddTrainCommand(app);
#endif
  AddCompletionCommand(app);
}

}  // namespace sinew::tools
