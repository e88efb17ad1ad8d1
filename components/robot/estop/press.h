// Presses the estop of this host: the client of estop::Listener.
//
// A stream socket: the answer comes back without an address of the caller, and every tool that can
// write to a Unix socket can press it (`echo hand | socat - UNIX-CONNECT:PATH`). Boundaries of
// messages are not needed, since there is one request: whatever is written is an estop, and its
// text the reason. The answers are lines:
//
//     idle                    the axes have reported it since the frames that idle them were sent
//     idle not confirmed: WHY not within kConfirmLimit; the estop is latched all the same
//     latched | not latched: WHY
//
// Answers count only where nobody but root, this process' user and the owner of the socket's folder
// can give them (SO_PEERCRED, socket_folder.h). What another user listens to is pressed all the
// same, since that stops at most one robot more.
//
// Thread: one.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

#include "components/base/config/descriptor.h"

namespace sinew::estop {

// For the whole answer: the axes' report (kConfirmLimit of listener.h), then the disk.
inline constexpr std::chrono::milliseconds kAnswerLimit{600};

class Press {
 public:
  // Connects and sends; waits for neither, but for a socket whose queue is full at most 100 ms.
  Press(const std::filesystem::path& socket, const std::string& reason);

  bool sent() const { return socket_.get() >= 0; }
  const std::string& error() const { return error_; }  // not sent: why

  struct Answer {
    bool idle = false;
    bool latched = false;
    std::string text;  // of the lines
  };
  // Until the last line or the time is over. Of another user's socket at once: why it does not
  // count.
  Answer Await(std::chrono::milliseconds timeout);

 private:
  config::Descriptor socket_;
  std::string error_;
  std::string doubt_;  // sent, but what is answered does not count: why
};

}  // namespace sinew::estop
