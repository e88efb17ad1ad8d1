#include "components/record/logger/player/control_socket.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "components/base/config/config.h"
#include "components/base/config/descriptor.h"
#include "components/base/config/unix_socket.h"

namespace sinew::logger {

namespace {

namespace fs = std::filesystem;
using config::Descriptor;
using std::chrono::milliseconds;

constexpr std::size_t kLongestLine = 256;
// A client that sends no line is dropped after this: others wait behind it.
constexpr milliseconds kLineLimit(1000);
// The player replies between two messages; while a reader in lockstep takes nothing it waits for it
// (its own limit is --wait-timeout), and the client gets to know that.
constexpr milliseconds kReplyLimit(5000);

bool Readable(int descriptor, milliseconds limit) {
  pollfd waiting{descriptor, POLLIN, 0};
  return ::poll(&waiting, 1, static_cast<int>(limit.count())) > 0;
}

// Up to the end of the line or of what was sent; empty: nothing within the limit.
std::string ReadLine(int descriptor, milliseconds limit) {
  std::string line;
  const auto end = std::chrono::steady_clock::now() + limit;
  while (line.find('\n') == std::string::npos && line.size() < kLongestLine) {
    const auto left =
        std::chrono::duration_cast<milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0 || !Readable(descriptor, left)) break;
    std::array<char, kLongestLine> bytes{};
    const ssize_t size = ::recv(descriptor, bytes.data(), bytes.size(), 0);
    if (size <= 0) break;
    line.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return line.substr(0, line.find('\n'));
}

int Connect(const fs::path& path) {
  const auto address = config::SocketAddress(path);
  if (!address) return -1;
  const int client = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (client < 0) return -1;
  if (::connect(client, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0) {
    return client;
  }
  ::close(client);
  return -1;
}

}  // namespace

fs::path PlayerSocket(int domain_id, const std::string& name) {
  const std::string file =
      "player-" + std::to_string(domain_id) + "-" + config::FileNamePart(name) + ".sock";
  return config::PrivateSocket("sinew-" + file);
}

ControlSocket::ControlSocket(fs::path path, PlayControl& control)
    : path_(std::move(path)), control_(control) {
  const auto fail = [this](const std::string& why) {
    if (listener_ >= 0) ::close(listener_);
    throw UsageError("socket of the player '" + path_.string() + "': " + why);
  };
  const auto address = config::SocketAddress(path_);
  if (!address) fail("the path is too long for a socket; give a shorter --name");
  if (const Descriptor other(Connect(path_)); other.get() >= 0) {
    fail("another player of this name answers there; give this one another --name");
  }
  listener_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (listener_ < 0) fail(std::strerror(errno));
  struct stat info {};
  if (::lstat(path_.c_str(), &info) == 0) {  // of a player that was killed
    if (!S_ISSOCK(info.st_mode)) fail("is there and is no socket");
    if (::unlink(path_.c_str()) != 0) fail(std::strerror(errno));
  }
  // Nobody can connect before listen(): the mode is there first.
  if (::bind(listener_, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0 ||
      ::chmod(path_.c_str(), S_IRUSR | S_IWUSR) != 0 || ::listen(listener_, 4) != 0) {
    fail(std::strerror(errno));
  }
  stop_ = ::eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { Run(); });
}

ControlSocket::~ControlSocket() {
  control_.Close();  // nobody replies any more
  const std::uint64_t one = 1;
  (void)!::write(stop_, &one, sizeof one);
  thread_.join();
  ::close(stop_);
  ::close(listener_);
  ::unlink(path_.c_str());
}

void ControlSocket::Run() {
  for (;;) {
    std::array<pollfd, 2> waiting{{{stop_, POLLIN, 0}, {listener_, POLLIN, 0}}};
    (void)::poll(waiting.data(), waiting.size(), -1);
    if (waiting[0].revents != 0) return;
    const Descriptor client(::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC));
    if (client.get() >= 0) Serve(client.get());
  }
}

void ControlSocket::Serve(int client) {
  std::string answer;
  try {
    const PlayRequest request = ParsePlayRequest(ReadLine(client, kLineLimit));
    std::string reply;
    const bool replied = control_.Ask(request, kReplyLimit, &reply);
    answer = replied ? reply : "error no reply: the player has ended, or waits for a reader";
  } catch (const std::invalid_argument& error) {
    answer = std::string("error ") + error.what();
  }
  answer += '\n';
  (void)!::send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
}

std::string AskPlayer(const fs::path& path, const std::string& line, milliseconds limit) {
  const Descriptor client(Connect(path));
  if (client.get() < 0) {
    throw UsageError("no player answers at " + path.string() +
                     "; is it running, on this host, by this user, under this name and domain?");
  }
  if (const uid_t user = config::PeerOf(client.get()).uid; user != ::getuid()) {
    throw UsageError(path.string() + ": user " + std::to_string(user) + " answers, expected " +
                     std::to_string(::getuid()));
  }
  const std::string request = line + "\n";
  const ssize_t size = ::send(client.get(), request.data(), request.size(), MSG_NOSIGNAL);
  if (size != static_cast<ssize_t>(request.size())) {
    throw UsageError("the player at " + path.string() + " took no request");
  }
  std::string answer = ReadLine(client.get(), limit);
  if (answer.empty()) throw UsageError("the player at " + path.string() + " gave no answer");
  return answer;
}

}  // namespace sinew::logger
