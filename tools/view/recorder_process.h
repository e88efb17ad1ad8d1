// A sinew-logger that the page starts and stops. One thread, the one that starts it: the logger
// ends with that thread.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "components/topics/node/options.h"
#include "tools/launch/program.h"

namespace sinew::live {

class RecorderProcess {
 public:
  // Recordings are FOLDER/view_TIME.mcap. Throws UsageError: no such folder.
  RecorderProcess(const node::Options& options, std::filesystem::path folder);
  ~RecorderProcess();  // a recording that runs is ended in order
  RecorderProcess(const RecorderProcess&) = delete;
  RecorderProcess& operator=(const RecorderProcess&) = delete;

  // Empty, or why not.
  std::string Start();
  void Stop();  // it writes what waits, and ends
  void Step();  // notices its end; waits for nothing

  bool running() const { return program_ != nullptr; }
  bool stopping() const { return stopping_; }
  const std::filesystem::path& file() const { return file_; }  // the last one; empty: none yet
  const std::string& problem() const { return problem_; }      // of the last one; empty: none

 private:
  const node::Options options_;
  const std::filesystem::path folder_;
  std::filesystem::path file_;
  std::unique_ptr<launch::Program> program_;
  bool stopping_ = false;
  std::string problem_;
};

// The name of a recording that begins at a time ("2024-05-17T09:30:00Z"), without colons.
std::string RecordingName(const std::string& utc);

// The last line of a text that is not empty.
std::string LastLine(const std::string& text);

}  // namespace sinew::live
