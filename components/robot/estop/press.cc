#include "components/robot/estop/press.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "components/base/config/unix_socket.h"
#include "components/robot/estop/socket_folder.h"

namespace sinew::estop {
namespace {

// Why an answer of that process does not count; empty: it does.
std::string DoubtOf(const std::filesystem::path& socket, const ucred& peer) {
  const SocketFolder folder = FolderOf(socket);
  if (!folder.problem.empty()) return folder.problem;
  if (folder.Admits(peer.uid)) return "";
  return "user " + std::to_string(peer.uid) + " listens there, expected root, this user or user " +
         std::to_string(folder.owner) + ", the owner of its folder";
}

}  // namespace

Press::Press(const std::filesystem::path& socket, const std::string& reason) {
  const auto address = config::SocketAddress(socket);
  if (!address) {
    error_ = socket.string() + ": the path is too long for a socket";
    return;
  }
  socket_ = config::Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int connected = socket_.get();
  const timeval limit{0, 100'000};  // connect() waits while the listener's queue is full
  ::setsockopt(connected, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  const std::string text = (reason.empty() ? std::string("estop") : reason) + "\n";
  const bool done =
      connected >= 0 &&
      ::connect(connected, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0 &&
      ::send(connected, text.data(), text.size(), MSG_NOSIGNAL) > 0;
  if (done) {
    doubt_ = DoubtOf(socket, config::PeerOf(connected));
    return;
  }
  error_ = socket.string() + ": " + std::strerror(errno);
  socket_.Close();
}

Press::Answer Press::Await(std::chrono::milliseconds timeout) {
  Answer answer;
  if (!doubt_.empty()) {
    answer.text = "pressed, but its answer does not count: " + doubt_ + "\n";
    return answer;
  }
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (sent()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    if (left.count() < 0) break;
    pollfd waiting{socket_.get(), POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(left.count()) + 1) == 0) break;
    std::array<char, 256> buffer;
    const ssize_t size = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (size <= 0) break;  // all is said
    answer.text.append(buffer.data(), static_cast<std::size_t>(size));
  }
  answer.idle = answer.text.starts_with("idle\n");
  answer.latched = answer.text.find("\nlatched\n") != std::string::npos;
  return answer;
}

}  // namespace sinew::estop
