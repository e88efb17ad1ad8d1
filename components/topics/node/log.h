// The log of a participant, on its error stream. Logging never waits: lines go into a queue of
// 1024, a thread of SCHED_OTHER writes them. While nobody reads the stream (a full pipe, a stopped
// terminal) the oldest lines are dropped; how many, is in the log when it goes on.
//
// The same thread keeps the newest 256 lines from level info on for the topic `log`, which a thread
// that may write to DDS sends (status.h): the caller of a log function has no more work by it.
#pragma once

#include <sinew_idl/log.h>

#include <chrono>
#include <optional>
#include <string>

#include "components/topics/node/helper_thread.h"

namespace sinew::node::internal {

// Sets what stands before the text of each line of spdlog's default logger. The text is one line
// without control characters (types::Printable).
void SetLogPattern(const std::string& before_text);

// Once a process. Makes the default logger of spdlog.
void StartLog(const std::string& name, const std::string& level);

// Until everything logged so far is written or the time is over; without StartLog nothing. False:
// the time is over, and nobody reads the stream.
bool FlushLog(std::chrono::milliseconds time);

// Lines for the topic `log` are kept, and no thread sends them yet.
bool LogIsUnsent();
// `wake_up` is given with every line until this is called with nullptr.
void WakeForLog(WakeUp* wake_up);
// The next line to send, without its header. Where lines were dropped, one that says how many is
// first. What the calling thread logs itself is never among them. Thread: the one that sends.
std::optional<msg::LogLine> NextLogLine();

}  // namespace sinew::node::internal
