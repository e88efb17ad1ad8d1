// The commands of `sinew`: each function adds its subcommands to the program and stands in the file
// of their name. Set-up only.
//
// AddAllCommands is written by CMake: it calls every function that sinew_add_commands
// (cmake/SinewModules.cmake) registered, AddCoreCommands first.
#pragma once

namespace CLI {
class App;
}

namespace sinew::tools {

void AddAllCommands(CLI::App& app);
// Those that are there in every build: the ones below, `experiment` and `train`.
void AddCoreCommands(CLI::App& app);

// `sinew launch`: starts the processes of a deployment file; `sinew compose`: with the provider's
// chain as one process.
void AddLaunchCommand(CLI::App& app);
void AddComposeCommand(CLI::App& app);
// `sinew isolate`: holds the network of a deployment. `sinew enter`: runs a program in it.
void AddIsolateCommands(CLI::App& app);
// `sinew arm`, `disarm`, `estop`, `reset`: commands of the operator.
void AddOperatorCommands(CLI::App& app);
// `sinew handover`: a role goes from the participant that has it to another one that stands by.
void AddHandoverCommand(CLI::App& app);
// `sinew permit-replay NAME`: the recording that NAME plays may move live hardware.
void AddPermitReplayCommand(CLI::App& app);
// `sinew conform ROLE PROGRAM`: the contract test of a program that takes a role.
void AddConformCommand(CLI::App& app);
// `sinew record`: records the topics of a domain, as sinew-logger does.
void AddRecordCommand(CLI::App& app);
// `sinew replay`: sends a recording into a domain, as sinew-player does.
void AddReplayCommand(CLI::App& app);
// `sinew replay-control`: pauses, steps, moves a running player of this host.
void AddReplayControlCommand(CLI::App& app);
// `sinew render`: a recording as a video.
void AddRenderCommand(CLI::App& app);
// `sinew import`: CSV files and a mapping into one recording.
void AddImportCommand(CLI::App& app);
// `sinew recover`: a whole recording out of one that was cut off.
void AddRecoverCommand(CLI::App& app);
// `sinew attachments`: the files that a recording carries.
void AddAttachmentsCommand(CLI::App& app);
// sinew new bench: the files of a bench of one's own.
void AddNewCommand(CLI::App& app);
// `sinew check-data`: checks of recordings before a fit.
void AddCheckDataCommand(CLI::App& app);
// `sinew close-loop`: which effect a model lacks, from recordings (components/model/close_loop).
void AddCloseLoopCommand(CLI::App& app);
// `sinew verify`: a corrected model in world and control, beside the one before.
void AddVerifyCommand(CLI::App& app);
// `sinew list`: participants, topics and problems of a domain; or what is in a recording.
void AddListCommand(CLI::App& app);
// `sinew echo`: messages of a topic, decoded.
void AddEchoCommand(CLI::App& app);
// `sinew log`: lines of the logs of all participants, live or of recordings.
void AddLogCommand(CLI::App& app);
// `sinew plot`: fields of recordings over time, in the terminal or as PNG and SVG files.
void AddPlotCommand(CLI::App& app);
// `sinew hz`: rate, jitter, age and loss of topics, live or of a recording.
void AddHzCommand(CLI::App& app);
// `sinew graph`: a picture of who speaks to whom, live or from a recording.
void AddGraphCommand(CLI::App& app);
// `sinew doctor`: what is wrong with host, shared memory, participants and CAN, with advice.
void AddDoctorCommand(CLI::App& app);
// `sinew effects`: the catalogue of effects.
void AddEffectsCommand(CLI::App& app);
// `sinew model`: model files.
void AddModelCommand(CLI::App& app);
// `sinew score`: errors of a recording.
void AddScoreCommand(CLI::App& app);
// `sinew performance`: tracking errors and energies of a recording.
void AddPerformanceCommand(CLI::App& app);
// `sinew completion`: scripts that complete the command's words.
void AddCompletionCommand(CLI::App& app);

}  // namespace sinew::tools
