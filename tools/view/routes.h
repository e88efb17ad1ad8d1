// Answers of the server to each request: the page, the robot, what goes on, commands.
//
//   GET  /, /FILE                the page (page.h)
//   GET  /robot.urdf, /robot/F   the URDF, and the files that it names
//   GET  /api/info               what does not change: JSON
//   GET  /api/status             what does: JSON
//   GET  /api/log?after=N        lines of the log that came after line N: JSON (shown_log.h)
//   GET  /api/recording          of a recording (recorded_view.h): file, sessions and topics, JSON
//   GET  /api/recording/messages?session=N&topics=A,B&from_ns=N&to_ns=N   a span of time
//   GET  /api/recording/participants?session=N&at_ns=N          a moment: JSON
//   GET  /api/recording/log?session=N&at_ns=N          the newest lines at a moment: JSON
//   POST /api/estop, disarm, arm, reset, record/start, record/stop   commands, 202 when taken
//
// Called by the thread of the server; the functions must not wait.
#pragma once

#include <functional>
#include <string>

#include "tools/view/page.h"
#include "tools/view/recorded_view.h"
#include "tools/view/robot.h"
#include "tools/view/server.h"
#include "tools/view/shown_log.h"

namespace sinew::live {

enum class Command { kEstop, kDisarm, kArm, kReset, kStartRecording, kStopRecording };

struct Routes {
  const Page* page = nullptr;
  const Robot* robot = nullptr;            // null: no URDF
  const RecordedView* recorded = nullptr;  // null: live
  bool allow_arming = false;               // arm and reset
  std::string info;                        // JSON
  std::function<std::string()> status;     // JSON; empty function: there is none
  const ShownLog* log = nullptr;           // null: a recording
  // Empty, or why it is not taken.
  std::function<std::string(Command)> command;  // empty function: there is none

  HttpReply Answer(const HttpRequest& request) const;
};

// "%20" becomes a blank; what is no such escape stays as it is.
std::string PercentDecoded(const std::string& text);

}  // namespace sinew::live
