// Remote control of a player on this host: a Unix socket beside the process, one request a
// connection.
//
// A client sends one line (play_control.h says which), the player answers with one line and closes:
// "ok STATUS" or "error REASON". Only the same user can connect (mode 0600). Why no topic:
// docs/decisions/0018-replay-control.md.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "components/record/logger/player/play_control.h"

namespace sinew::logger {

// Path of a player's socket, by its participant name: config::PrivateSocket, which throws. Names
// are those of participants; other characters than letters, digits, _ - . become _.
std::filesystem::path PlayerSocket(int domain_id, const std::string& name);

class ControlSocket {
 public:
  // Opens the socket and starts the thread that serves it. Keeps a reference to the control. Throws
  // UsageError: the socket cannot be made, or another player answers there.
  ControlSocket(std::filesystem::path path, PlayControl& control);
  ~ControlSocket();  // ends the thread, removes the socket
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  void Run();
  void Serve(int client);

  const std::filesystem::path path_;
  PlayControl& control_;
  int listener_ = -1, stop_ = -1;
  std::thread thread_;
};

// Sends a request and gives the answer's line. Throws UsageError when no player answers there.
std::string AskPlayer(const std::filesystem::path& path, const std::string& line,
                      std::chrono::milliseconds limit);

}  // namespace sinew::logger
