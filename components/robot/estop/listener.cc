#include "components/robot/estop/listener.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "components/base/config/unix_socket.h"
#include "components/base/types/clock/clock.h"
#include "components/robot/estop/socket_folder.h"

namespace sinew::estop {
namespace {

constexpr std::size_t kMostClients = 32;
constexpr std::int64_t kRetry_ns = 1'000'000'000;     // a latch that could not be written
constexpr std::int64_t kAcceptPause_ns = 10'000'000;  // what cannot be accepted is tried again
constexpr std::int64_t kConfirmLimit_ns = std::chrono::nanoseconds(kConfirmLimit).count();

// Does not wait: where connections queue up, a process is there.
bool SomebodyAnswers(const sockaddr_un& address) {
  const config::Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 ||
         errno == EAGAIN;
}

config::Descriptor Spare() { return config::Descriptor(::open("/dev/null", O_RDONLY | O_CLOEXEC)); }

// Raises the thread above the cycle that it must interrupt, where the process runs SCHED_FIFO.
void RaisePriority(int priority) {
  int policy = SCHED_OTHER;
  sched_param parameters{};
  ::pthread_getschedparam(::pthread_self(), &policy, &parameters);
  if (policy != SCHED_FIFO || priority <= parameters.sched_priority) return;
  parameters.sched_priority = priority;
  (void)::pthread_setschedparam(::pthread_self(), policy, &parameters);
}

}  // namespace

Listener::Listener(const Config& config, Callbacks callbacks, int priority)
    : callbacks_(std::move(callbacks)) {
  if (config.latch) {
    latch_.emplace(*config.latch);
    lock_ = latch_->Lock();
    at_start_ = latch_->Read();
    on_disk_ = at_start_.valid;
  }
  if (config.socket) OpenSocket(config);
  signal_ = config::Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  spare_ = Spare();
  thread_ = std::thread([this, priority] {
    ::pthread_setname_np(::pthread_self(), "estop");
    if (priority > 0) RaisePriority(priority);
    Run();
  });
}

Listener::~Listener() {
  stop_ = true;
  Signal();
  thread_.join();
  for (const Client& client : clients_) ::close(client.socket);
  if (listener_.get() >= 0) ::unlink(path_.c_str());
}

void Listener::OpenSocket(const Config& config) {
  path_ = *config.socket;
  const auto fail = [this](const std::string& why) {
    throw UsageError("estop socket '" + path_.string() + "': " + why + " (key estop.socket)");
  };
  const auto address = config::SocketAddress(path_);
  if (!address) fail("the path is too long for a socket");
  const SocketFolder folder = FolderOf(path_);
  if (const std::string why = RefusalToListen(folder, path_); !why.empty()) fail(why);
  struct stat info {};
  if (::lstat(path_.c_str(), &info) == 0) {
    if (!S_ISSOCK(info.st_mode)) fail("is no socket");
    // A provider that was killed has left it; or another user, when the folder was open to all.
    if (!folder.Admits(info.st_uid)) {
      callbacks_.report(true, path_.string() + ": a socket of user " + std::to_string(info.st_uid) +
                                  " was there, it is replaced");
    } else if (SomebodyAnswers(*address)) {
      fail("another process answers there");
    }
    if (::unlink(path_.c_str()) != 0) fail(std::strerror(errno));
  }
  config::Descriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // Nobody can connect before listen(): the mode is there first.
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0 ||
      ::chmod(path_.c_str(), config.socket_mode) != 0 || ::listen(listener.get(), 16) != 0) {
    fail(std::strerror(errno));
  }
  listener_ = std::move(listener);
}

// --- the cycle's thread

bool Listener::TakePress() noexcept {
  const std::uint64_t presses = presses_.load(std::memory_order_acquire);
  if (presses == taken_) return false;
  taken_ = presses;
  return true;
}

Listener::Presser Listener::presser() const noexcept {
  const std::uint64_t packed = presser_.load(std::memory_order_relaxed);
  return {static_cast<uid_t>(packed >> 32), static_cast<pid_t>(packed & 0xFFFFFFFF)};
}

void Listener::IdleSent(std::uint64_t covered) noexcept {
  if (idle_.load(std::memory_order_relaxed) >= covered) return;
  idle_.store(covered, std::memory_order_release);
  Signal();
}

void Listener::IdleConfirmed(std::uint64_t covered) noexcept {
  if (confirmed_.load(std::memory_order_relaxed) >= covered) return;
  confirmed_.store(covered, std::memory_order_release);
  Signal();
}

void Listener::Latch(std::string_view reason) {
  if (!latch_) return;
  {
    const std::lock_guard lock(reason_mutex_);
    if (reason_.empty()) reason_ = reason;
  }
  (void)Desire(true);
  Signal();
}

void Listener::RequestUnlatch() noexcept {
  unlatching_ = Desire(false);
  Signal();
}

Listener::Unlatch Listener::unlatch() const noexcept {
  const std::uint64_t done = done_.load(std::memory_order_acquire);
  if (done / 4 < unlatching_) return Unlatch::kPending;
  return done % 4 == 1 ? Unlatch::kDone : Unlatch::kFailed;
}

std::uint64_t Listener::Desire(bool latched) noexcept {
  std::uint64_t old = desired_.load();
  while (!desired_.compare_exchange_weak(old, (old / 2 + 1) * 2 + (latched ? 1 : 0))) {
  }
  return old / 2 + 1;
}

void Listener::Signal() noexcept {
  const std::uint64_t one = 1;
  (void)!::write(signal_.get(), &one, sizeof one);
}

// --- the listener's thread

void Listener::Run() {
  std::vector<pollfd> waiting;
  while (!stop_) {
    if (spare_.get() < 0) spare_ = Spare();
    const std::int64_t now_ns = types::MonotonicNow_ns();
    const int listener = accept_ns_ > now_ns ? -1 : listener_.get();  // -1: not polled
    waiting.assign({{signal_.get(), POLLIN, 0}, {listener, POLLIN, 0}});
    for (const Client& client : clients_) {
      waiting.push_back({client.press != 0 ? -1 : client.socket, POLLIN, 0});
    }
    int timeout_ms = -1;
    const auto until = [&](std::int64_t end_ns) {
      const std::int64_t left_ms = std::max<std::int64_t>(0, (end_ns - now_ns) / 1'000'000 + 1);
      if (timeout_ms < 0 || left_ms < timeout_ms) timeout_ms = static_cast<int>(left_ms);
    };
    if (AwaitsIdle()) until(pressed_ns_ + std::chrono::nanoseconds(kIdleLimit).count());
    for (const Client& client : clients_) {
      if (client.press != 0) until(client.pressed_ns + kConfirmLimit_ns);
    }
    if (retry_ns_ != 0) until(retry_ns_);
    if (listener != listener_.get()) until(accept_ns_);
    (void)::poll(waiting.data(), waiting.size(), timeout_ms);
    std::uint64_t count = 0;
    (void)!::read(signal_.get(), &count, sizeof count);
    for (std::size_t i = 2; i < waiting.size(); ++i) {
      if (waiting[i].revents != 0) Read(&clients_[i - 2]);
    }
    std::erase_if(clients_, [](const Client& client) { return client.socket < 0; });
    if ((waiting[1].revents & POLLIN) != 0) Accept();
    AnswerIdle();
    if (AwaitsIdle()) continue;
    MatchFile();
    AnswerLatch();
  }
}

void Listener::Accept() {
  const auto accept = [this] {
    return ::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  };
  int socket = accept();
  if (socket < 0 && (errno == EMFILE || errno == ENFILE) && FreeDescriptor()) socket = accept();
  if (socket < 0) {
    if (errno != EAGAIN) accept_ns_ = types::MonotonicNow_ns() + kAcceptPause_ns;
    return;
  }
  Client client{.socket = socket};
  Read(&client);  // the text is there already, as a rule
  if (client.socket < 0) return;
  if (clients_.size() >= kMostClients) {  // those who say nothing give way
    const auto silent = std::find_if(clients_.begin(), clients_.end(),
                                     [](const Client& c) { return c.press == 0; });
    const auto oldest = silent != clients_.end() ? silent : clients_.begin();
    ::close(oldest->socket);
    clients_.erase(oldest);
  }
  clients_.push_back(client);
}

// The spare one, else that of a client that says nothing.
bool Listener::FreeDescriptor() {
  if (spare_.get() >= 0) {
    spare_.Close();
    return true;
  }
  const auto silent =
      std::find_if(clients_.begin(), clients_.end(), [](const Client& c) { return c.press == 0; });
  if (silent == clients_.end()) return false;
  ::close(silent->socket);
  clients_.erase(silent);
  return true;
}

void Listener::Read(Client* client) {
  std::array<char, 256> text;
  ssize_t size = 0;
  do {
    size = ::recv(client->socket, text.data(), text.size(), MSG_DONTWAIT);
  } while (size < 0 && errno == EINTR);
  if (size > 0) {
    TakePressOf(client, std::string_view(text.data(), static_cast<std::size_t>(size)));
  } else if (size == 0 || errno != EAGAIN) {
    ::close(client->socket);
    client->socket = -1;
  }
}

void Listener::TakePressOf(Client* client, std::string_view reason) {
  client->press = presses_.load(std::memory_order_relaxed) + 1;
  client->pressed_ns = types::MonotonicNow_ns();
  const ucred peer = config::PeerOf(client->socket);
  presser_.store(std::uint64_t{peer.uid} << 32 | static_cast<std::uint32_t>(peer.pid),
                 std::memory_order_relaxed);
  presses_.store(client->press, std::memory_order_release);
  callbacks_.wake();
  // The first press that the cycle has not answered counts: more of them do not put the latch off.
  if (idle_.load(std::memory_order_acquire) + 1 >= client->press) {
    pressed_ns_ = client->pressed_ns;
  }
  const std::lock_guard lock(reason_mutex_);
  if (reason_.empty()) reason_ = std::string("socket: ") + std::string(reason);
}

bool Listener::AwaitsIdle() const noexcept {
  const std::uint64_t presses = presses_.load(std::memory_order_relaxed);
  return idle_.load(std::memory_order_acquire) < presses &&
         types::MonotonicNow_ns() - pressed_ns_ < std::chrono::nanoseconds(kIdleLimit).count();
}

void Listener::AnswerIdle() {
  const std::uint64_t confirmed = confirmed_.load(std::memory_order_acquire);
  for (Client& client : clients_) {
    if (client.press == 0 || client.idle_said || client.press > confirmed) continue;
    client.idle_said = true;
    Say(&client, "idle\n");
  }
}

// The file as the newest desire says; a press that the cycle has not taken yet counts, too.
void Listener::MatchFile() {
  std::uint64_t desired = desired_.load();
  const bool pressed = std::any_of(clients_.begin(), clients_.end(),
                                   [](const Client& c) { return c.press != 0 && !c.kept; });
  if (pressed && desired % 2 == 0) {
    (void)Desire(true);
    desired = desired_.load();
  }
  const bool retry = retry_ns_ != 0 && types::MonotonicNow_ns() >= retry_ns_;
  if (desired / 2 == done_.load(std::memory_order_relaxed) / 4 && !retry) return;
  const bool latched = desired % 2 == 1;
  std::string problem;
  if (latch_ && !(latched && on_disk_)) {
    std::string reason;
    {
      const std::lock_guard lock(reason_mutex_);
      reason = reason_;
    }
    spare_.Close();  // the file needs one
    problem = latched ? latch_->Write(reason) : latch_->Remove();
    if (problem.empty()) {
      on_disk_ = latched;
      callbacks_.report(false, latch_->path().string() + (latched ? ": latched" : ": removed"));
    } else if (problem != problem_) {
      callbacks_.report(true, "estop latch: " + problem +
                                  (latched ? "; the robot is ESTOPPED, but not after a restart"
                                           : "; the robot stays ESTOPPED"));
    }
  }
  problem_ = problem;
  retry_ns_ = latched && !problem.empty() ? types::MonotonicNow_ns() + kRetry_ns : 0;
  if (!latched || problem.empty()) {
    const std::lock_guard lock(reason_mutex_);
    reason_.clear();
  }
  done_.store(desired * 2 + (problem.empty() ? 1 : 0), std::memory_order_release);
  callbacks_.wake();  // a reset may go on
}

void Listener::AnswerLatch() {
  for (Client& client : clients_) {
    if (client.press == 0) continue;
    client.kept = true;
    if (!client.idle_said) {
      if (types::MonotonicNow_ns() - client.pressed_ns < kConfirmLimit_ns) continue;
      Say(&client, client.press > idle_.load(std::memory_order_acquire)
                       ? "idle not confirmed: the state provider's cycle does not answer\n"
                       : "idle not confirmed: its frames were sent, the axes do not report it\n");
    }
    Say(&client, !latch_            ? std::string("not latched: no latch file is declared\n")
                 : problem_.empty() ? std::string("latched\n")
                                    : "not latched: " + problem_ + "\n");
    ::close(client.socket);
    client.socket = -1;
  }
  std::erase_if(clients_, [](const Client& client) { return client.socket < 0; });
}

void Listener::Say(Client* client, std::string_view line) noexcept {
  (void)!::send(client->socket, line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace sinew::estop
