#include "tools/sinew/commands.h"

#include "tools/sinew/attachments.h"
#include "tools/sinew/check_data.h"
#include "tools/sinew/close_loop.h"
#include "tools/sinew/completion.h"
#include "tools/sinew/conform.h"
#include "tools/sinew/doctor.h"
#include "tools/sinew/echo.h"
#include "tools/sinew/effects.h"
#include "tools/sinew/experiment.h"
#include "tools/sinew/graph.h"
#include "tools/sinew/handover.h"
#include "tools/sinew/hz.h"
#include "tools/sinew/import.h"
#include "tools/sinew/isolate.h"
#include "tools/sinew/launch.h"
#include "tools/sinew/list.h"
#include "tools/sinew/model.h"
#include "tools/sinew/new.h"
#include "tools/sinew/operator.h"
#include "tools/sinew/performance.h"
#include "tools/sinew/permit_replay.h"
#include "tools/sinew/plot.h"
#include "tools/sinew/record.h"
#include "tools/sinew/recover.h"
#include "tools/sinew/render.h"
#include "tools/sinew/replay.h"
#include "tools/sinew/replay_control.h"
#include "tools/sinew/score.h"
#include "tools/sinew/train.h"
#include "tools/sinew/verify.h"

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
