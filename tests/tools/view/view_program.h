// The program sinew-view, for tests.
#pragma once

#include <chrono>
#include <csignal>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace sinew::testing {

constexpr std::chrono::seconds kViewLimit(30);
inline const std::string kViewBin = std::string(SINEW_BIN_DIR) + "/";

// A sinew-view with a page that answers.
class View {
 public:
  explicit View(const std::vector<std::string>& arguments) : program_(Line(arguments)) {
    if (!program_.WaitForText("page and Foxglove WebSocket at", kViewLimit)) return;
    static const std::regex kAddress(R"(at http://127\.0\.0\.1:(\d+)/)");
    const std::string log = program_.output() + program_.error();
    std::smatch match;
    if (std::regex_search(log, match, kAddress)) port_ = match[1];
  }
  const std::string& port() const { return port_; }
  std::string log() const { return program_.output() + program_.error(); }
  pid_t pid() const { return program_.pid(); }
  int End() {
    program_.Signal(SIGINT);
    return program_.Wait(kViewLimit);
  }
  Finished Ask(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(),
                     {"node", SINEW_SOURCE_DIR "/tests/tools/view/live_client.mjs", port_});
    return Run(arguments, std::chrono::seconds(60));
  }

 private:
  static std::vector<std::string> Line(const std::vector<std::string>& arguments) {
    std::vector<std::string> line = {kViewBin + "sinew-view", "--port", "0"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    return line;
  }
  Program program_;
  std::string port_;
};

}  // namespace sinew::testing
