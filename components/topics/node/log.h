// The log of a participant, on its error stream. Logging never waits: lines go into a queue of
// 1024, a thread of SCHED_OTHER writes them. While nobody reads the stream (a full pipe, a stopped
// terminal) the oldest lines are dropped; how many, is in the log when it goes on.
#pragma once

#include <chrono>
#include <string>

namespace sinew::node::internal {

// Sets what stands before the text of each line of spdlog's default logger. The text is one line
// without control characters (types::Printable).
void SetLogPattern(const std::string& before_text);

// Once a process. Makes the default logger of spdlog.
void StartLog(const std::string& name, const std::string& level);

// Until everything logged so far is written or the time is over; without StartLog nothing. False:
// the time is over, and nobody reads the stream.
bool FlushLog(std::chrono::milliseconds time);

}  // namespace sinew::node::internal
