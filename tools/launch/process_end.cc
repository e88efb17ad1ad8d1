#include "tools/launch/process_end.h"

#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <cstring>

namespace sinew::launch {
namespace {

constexpr double kLongestBackOff_s = 60.0;
constexpr int kMostDoublings = 20;

bool EndedByStopSignal(int status) {
  for (const int signal : {SIGINT, SIGTERM}) {
    if (WIFSIGNALED(status) && WTERMSIG(status) == signal) return true;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 128 + signal) return true;
  }
  return false;
}

}  // namespace

std::string CauseOf(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return "signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  }
  return "exit code " + std::to_string(WEXITSTATUS(status));
}

bool Failed(const ProcessEnd& end) {
  return end.status != 0 && !(end.asked_to_stop && EndedByStopSignal(end.status));
}

bool StartsAgain(const Process& process, const ProcessEnd& end) {
  const bool failed = Failed(end);
  const bool wanted = process.restart == Restart::kAlways
                          ? !(end.is_provider && !failed)
                          : process.restart == Restart::kOnFailure && failed;
  return !end.deployment_stops && wanted && end.restarts < process.max_restarts;
}

double BackOff_s(const Process& process, int restarts) {
  return std::min(
      kLongestBackOff_s,
      process.back_off_s * static_cast<double>(1 << std::min(restarts, kMostDoublings)));
}

}  // namespace sinew::launch
