// Programs under test, under the name that tests use, and processes by their id.
#pragma once

#include <sys/types.h>

#include <chrono>

#include "tools/launch/program.h"

namespace sinew::testing {

using launch::Finished;
using launch::Program;
using launch::Run;

// True while a process of this id exists and is no zombie.
bool IsRunning(pid_t pid);
// Waits until it is not.
bool WaitUntilGone(pid_t pid, std::chrono::milliseconds limit);

}  // namespace sinew::testing
