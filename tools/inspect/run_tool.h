// Programs of others as child processes: a text in, text out. No shell.
#pragma once

#include <string>
#include <vector>

namespace sinew::inspect {

struct ToolResult {
  bool found = true;  // false: the program is not in PATH
  int exit_code = 0;  // launch::Program::kTimeout after a minute
  std::string output, error;
};

// Looks the program up in PATH and collects both outputs until it ends. `input`, unless empty, is
// the content of a temporary file whose name becomes the last argument. Throws std::runtime_error
// when that file cannot be written.
ToolResult RunTool(const std::string& program, const std::vector<std::string>& arguments,
                   const std::string& input = {});

// Its standard output. Throws UsageError when the program is absent, naming its Debian package;
// std::runtime_error with its words when it fails.
std::string OutputOf(const std::string& program, const std::string& package,
                     const std::vector<std::string>& arguments, const std::string& input = {});

}  // namespace sinew::inspect
