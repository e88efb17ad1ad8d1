#include "tools/view/recorder_process.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <utility>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "tools/launch/find_program.h"

namespace sinew::live {

namespace fs = std::filesystem;

namespace {

// For what waits in its queue, 16 MiB, to reach a disk of 5 MB/s, rounded up.
constexpr std::chrono::seconds kEndLimit(4);

}  // namespace

std::string RecordingName(const std::string& utc) {
  std::string name = "view_" + utc + ".mcap";
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

std::string LastLine(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return {};
  const std::size_t begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

RecorderProcess::RecorderProcess(const node::Options& options, fs::path folder)
    : options_(options), folder_(std::move(folder)) {
  std::error_code error;
  if (!fs::is_directory(folder_, error)) {
    throw UsageError("--record-folder " + folder_.string() + ": expected a folder that is there");
  }
}

RecorderProcess::~RecorderProcess() {
  if (!program_) return;
  Stop();
  (void)program_->Wait(kEndLimit);
}

std::string RecorderProcess::Start() {
  if (program_) return "a recording runs already";
  const fs::path program =
      launch::FindProgram("sinew-logger", fs::current_path(), launch::ProgramFolder());
  if (program.empty()) return launch::NoProgram("sinew-logger", launch::ProgramFolder());
  file_ = folder_ / RecordingName(types::UtcNow());
  std::vector<std::string> line = {program.string(),
                                   "--name",
                                   options_.name + "-logger",
                                   "--domain",
                                   std::to_string(options_.domain_id),
                                   "--out",
                                   file_.string(),
                                   "--keep-going",
                                   "--note",
                                   "started_by=" + options_.name};
  for (const std::string& name : options_.interfaces) {
    line.insert(line.end(), {"--interface", name});
  }
  if (!options_.qos_path.empty()) line.insert(line.end(), {"--qos", options_.qos_path.string()});
  if (options_.mode == node::TimeMode::kLockstep) line.push_back("--lockstep");
  problem_.clear();
  stopping_ = false;
  try {
    program_ = std::make_unique<launch::Program>(line);
  } catch (const std::runtime_error& error) {
    problem_ = error.what();
  }
  return problem_;
}

void RecorderProcess::Stop() {
  if (!program_ || std::exchange(stopping_, true)) return;
  program_->Signal(SIGINT);
}

void RecorderProcess::Step() {
  if (!program_) return;
  const int status = program_->Wait(std::chrono::milliseconds(0));
  if (status == launch::Program::kTimeout) return;
  if (status != 0) {
    problem_ = LastLine(program_->error());
    if (problem_.empty()) problem_ = "the logger ended with " + std::to_string(status);
  }
  program_.reset();
  stopping_ = false;
}

}  // namespace sinew::live
