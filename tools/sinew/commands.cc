#include "tools/sinew/commands.h"
#include "tools/sinew/experiment.h"
#include "tools/sinew/train.h"

namespace sinew::tools {

void AddCoreCommands(CLI::App& app) {
  AddLaunchCommand(app);
  AddComposeCommand(app);
  AddIsolateCommands(app);
  AddOperatorCommands(app);
  AddHandoverCommand(app);
  AddConformCommand(app);
  AddPermitReplayCommand(app);
  AddRecordCommand(app);
  AddReplayCommand(app);
  AddReplayControlCommand(app);
  AddRenderCommand(app);
  AddImportCommand(app);
  AddRecoverCommand(app);
  AddAttachmentsCommand(app);
  AddNewCommand(app);
  AddCheckDataCommand(app);
  AddCloseLoopCommand(app);
  AddVerifyCommand(app);
  AddExperimentCommand(app);
  AddListCommand(app);
  AddEchoCommand(app);
  AddLogCommand(app);
  AddPlotCommand(app);
  AddHzCommand(app);
  AddGraphCommand(app);
  AddDoctorCommand(app);
  AddEffectsCommand(app);
  AddModelCommand(app);
  AddTrainCommand(app);
  AddScoreCommand(app);
  AddPerformanceCommand(app);
  AddCompletionCommand(app);
}

}  // namespace sinew::tools
