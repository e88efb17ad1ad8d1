#include "tools/inspect/run_tool.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "components/base/config/config.h"
#include "tools/launch/program.h"

namespace sinew::inspect {

namespace {

constexpr std::chrono::minutes kToolLimit(1);
constexpr int kNotFound = 127;  // of execvp that failed, as of a shell

// Gone with its object.
class InputFile {
 public:
  explicit InputFile(const std::string& content)
      : path_((std::filesystem::temp_directory_path() / "sinew_input.XXXXXX").string()) {
    const int descriptor = ::mkstemp(path_.data());
    if (descriptor < 0) throw std::runtime_error("no temporary file " + path_);
    ::close(descriptor);
    std::ofstream file(path_, std::ios::binary);
    file << content;
    file.close();
    if (file) return;
    ::unlink(path_.c_str());
    throw std::runtime_error(path_ + " cannot be written");
  }
  ~InputFile() { ::unlink(path_.c_str()); }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

ToolResult RunTool(const std::string& program, const std::vector<std::string>& arguments,
                   const std::string& input) {
  std::vector<std::string> line{program};
  line.insert(line.end(), arguments.begin(), arguments.end());
  launch::Finished finished;
  if (input.empty()) {
    finished = launch::Run(line, kToolLimit);
  } else {
    const InputFile file(input);
    line.push_back(file.path());
    finished = launch::Run(line, kToolLimit);
  }
  return {finished.exit_code != kNotFound, finished.exit_code, std::move(finished.output),
          std::move(finished.error)};
}

std::string OutputOf(const std::string& program, const std::string& package,
                     const std::vector<std::string>& arguments, const std::string& input) {
  ToolResult result = RunTool(program, arguments, input);
  if (!result.found) {
    throw UsageError("the program '" + program +
                     "' was not found, expected it in PATH (apt-get install " + package + ")");
  }
  if (result.exit_code != 0) throw std::runtime_error(program + " failed: " + result.error);
  return std::move(result.output);
}

}  // namespace sinew::inspect
