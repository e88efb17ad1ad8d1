#include "tools/view/routes.h"

#include <array>
#include <charconv>
#include <string_view>

#include "components/base/config/config.h"

namespace sinew::live {

namespace {

struct CommandRoute {
  const char* path;
  Command command;
  bool moves;  // only with --allow-arming: the robot may move afterwards
};
constexpr std::array<CommandRoute, 6> kCommands = {{
    {"/api/estop", Command::kEstop, false},
    {"/api/disarm", Command::kDisarm, false},
    {"/api/arm", Command::kArm, true},
    {"/api/reset", Command::kReset, true},
    {"/api/record/start", Command::kStartRecording, false},
    {"/api/record/stop", Command::kStopRecording, false},
}};
constexpr std::string_view kMeshFolder = "/robot/";
constexpr std::string_view kRecordingPath = "/api/recording";

HttpReply Refuse(unsigned status, const std::string& why) {
  return {status, "text/plain; charset=utf-8", why + "\n"};
}

HttpReply AnswerCommand(const Routes& routes, const HttpRequest& request) {
  for (const CommandRoute& route : kCommands) {
    if (request.path != route.path) continue;
    if (!request.why_no_command.empty()) return Refuse(403, request.why_no_command);
    if (!routes.command) return Refuse(409, "a recording takes no commands");
    if (route.moves && !routes.allow_arming) {
      return Refuse(403, "arming from the page is off, expected sinew-view --allow-arming");
    }
    const std::string why = routes.command(route.command);
    return why.empty() ? Refuse(202, "taken") : Refuse(409, why);
  }
  return Refuse(404, request.path + ": no such command");
}

HttpReply AnswerLog(const ShownLog* log, const HttpRequest& request) {
  if (log == nullptr) return Refuse(404, "a recording has no live log");
  try {
    return {200, "application/json", log->After(request.query)};
  } catch (const UsageError& error) {
    return Refuse(400, error.what());
  }
}

HttpReply AnswerRecording(const RecordedView* recorded, const HttpRequest& request) {
  if (recorded == nullptr) return Refuse(404, "no recording is shown");
  const std::string_view what = std::string_view(request.path).substr(kRecordingPath.size());
  try {
    if (what.empty()) return {200, "application/json", recorded->Description()};
    if (what == "/messages") {
      return {200, "application/octet-stream", recorded->Messages(ParseQuery(request.query))};
    }
    if (what == "/participants") {
      return {200, "application/json", recorded->ParticipantsAt(ParseMoment(request.query))};
    }
    if (what == "/log") {
      return {200, "application/json", recorded->LogAt(ParseMoment(request.query))};
    }
  } catch (const UsageError& error) {
    return Refuse(400, error.what());
  }
  return Refuse(404, request.path + ": a recording has /messages, /participants and /log");
}

}  // namespace

std::string PercentDecoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

HttpReply Routes::Answer(const HttpRequest& request) const {
  if (request.method == "POST") return AnswerCommand(*this, request);
  if (request.method != "GET") return Refuse(405, "expected GET or POST");
  if (request.path == "/api/info") return {200, "application/json", info};
  if (request.path == "/api/status") {
    return status ? HttpReply{200, "application/json", status()}
                  : Refuse(404, "a recording has no status");
  }
  if (request.path == "/api/log") return AnswerLog(log, request);
  if (request.path.starts_with(kRecordingPath)) return AnswerRecording(recorded, request);
  if (request.path == "/robot.urdf") {
    return robot == nullptr ? Refuse(404, "no URDF, expected --urdf")
                            : HttpReply{200, "application/xml", robot->urdf()};
  }
  if (request.path.starts_with(kMeshFolder)) {
    return robot == nullptr ? Refuse(404, "no URDF, expected --urdf")
                            : robot->Mesh(PercentDecoded(request.path.substr(kMeshFolder.size())));
  }
  return page->Get(request.path, request.page_token);
}

}  // namespace sinew::live
