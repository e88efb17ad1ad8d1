// The checks, in three parts that each start the program anew. A check adds one row; those that
// need a program that runs add none when it does not start.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "components/topics/node/options.h"
#include "tools/conform/conform.h"
#include "tools/conform/report.h"
#include "tools/conform/role.h"

namespace sinew::conform {

// Time in which a program that was asked to stop has ended.
inline constexpr std::chrono::milliseconds kEnd(2000);
// Time after its start until its endpoints and its status are there, or it has refused its options;
// a program of the project takes 0.2 s, loading the largest network 1 s on a busy machine.
inline constexpr std::chrono::milliseconds kStart(5000);
// Real time on a machine that is not. A window is 12 ticks, 50 ms at 240 Hz; of its ticks this
// share has to be answered, with the flags that are expected. On a busy machine a window may miss
// it; a program that breaks a rule misses it in all, also in those whose ticks are slower.
inline constexpr int kWindowTicks = 12;
inline constexpr double kMostTicks = 0.8;
struct WindowRule {
  double share_of_rate;
  int windows;
};
inline constexpr WindowRule kWindows[] = {{1.0, 6}, {0.25, 3}, {0.0625, 2}};
// Whether answers come within their cycle is seen at the full rate alone: 2 s of it at most.
inline constexpr int kLatencyWindows = 40;

// Program, common options and its own arguments.
std::vector<std::string> SubjectCommandLine(const Options& options, const std::string& name,
                                            node::TimeMode mode);

// Checks that are made together, and what makes them.
template <class... Arguments>
struct Part {
  std::vector<std::string> checks;
  void (*run)(Arguments...);

  bool IsWanted(const Options& options) const {
    return options.only.empty() || std::any_of(checks.begin(), checks.end(), [&](const auto& name) {
             return std::find(options.only.begin(), options.only.end(), name) != options.only.end();
           });
  }
};
using ProgramPart = Part<const Options&, const Role&, Report*>;
const std::vector<ProgramPart>& ProgramParts();

// Configuration: files that do not exist, keys that nobody knows, none at all. Without DDS.
void CheckConfiguration(const Options& options, const Role& role, Report* report);
// Start, types, owners, ticks, lost inputs, sessions, origins, malformed messages, SIGTERM.
void CheckRealTime(const Options& options, const Role& role, Report* report);
// Every tick answered, twice the same; end of the session, SIGINT.
void CheckLockstep(const Options& options, const Role& role, Report* report);

}  // namespace sinew::conform
