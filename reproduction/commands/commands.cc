#include "reproduction/commands/commands.h"

#include <CLI/CLI.hpp>

#include "reproduction/commands/compare.h"
#include "reproduction/commands/control_test.h"
#include "reproduction/commands/experiment.h"
#include "reproduction/commands/paper.h"
#include "reproduction/commands/search.h"
#include "reproduction/commands/squat_test.h"
#include "reproduction/commands/tables.h"
#include "reproduction/commands/train_net.h"
#include "tools/sinew/experiment.h"
#include "tools/sinew/train.h"

namespace sinew::reproduction {

void AddCommands(CLI::App& app) {
  // The same command with the surrogate beside topics and recordings.
  app.remove_subcommand(app.get_subcommand("experiment"));
  tools::AddExperimentCommand(app, MakeSurrogateExperiments());
  // The same command with the published models beside the echo state networks.
  app.remove_subcommand(app.get_subcommand("train"));
  tools::AddTrainCommand(app, MakePublishedNetworks());
  AddCompareCommand(app);
  AddSearchCommand(app);
  AddControlTestCommand(app);
  AddSquatTestCommand(app);
  AddTablesCommand(app);
  AddPaperCommand(app);
}

}  // namespace sinew::reproduction
