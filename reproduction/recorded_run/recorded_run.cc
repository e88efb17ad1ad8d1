#include "reproduction/recorded_run/recorded_run.h"

#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/launch/launcher.h"
#include "tools/launch/output.h"

namespace sinew::reproduction {
namespace {

void RunOnce(const RecordedRun& run) {
  const std::filesystem::path part =
      std::filesystem::path(run.recording).replace_extension(".part.mcap");
  std::filesystem::remove(part);
  launch::Overrides overrides = run.overrides;
  overrides.record = part;
  const launch::Deployment deployment = launch::LoadDeployment(
      run.deployment, overrides, run.programs.empty() ? launch::ProgramFolder() : run.programs);
  std::vector<std::string> names;
  for (const launch::Process& process : deployment.processes) names.push_back(process.name);
  std::ofstream log(run.log);
  launch::Output output(log, log, false, names);
  const launch::Result result = launch::RunDeployment(deployment, output);
  if (result.stopped_by_user) throw std::runtime_error("stopped as asked");
  if (!result.ok()) {
    const launch::Failure& failure = result.failures.front();
    std::string text = run.name + ": " + failure.process + ": " + failure.cause;
    for (const std::string& line : failure.last_lines) text += "\n    " + line;
    throw std::runtime_error(text);
  }
  std::filesystem::rename(part, run.recording);
}

}  // namespace

void RunRecorded(const RecordedRun& run) {
  try {
    RunOnce(run);
  } catch (const std::runtime_error& error) {
    // Processes of a busy machine that did not find each other.
    if (std::string(error.what()).find("for tick 0 within") == std::string::npos) throw;
    std::fprintf(stderr, "%s\nstarted once more\n", error.what());
    RunOnce(run);
  }
}

}  // namespace sinew::reproduction
