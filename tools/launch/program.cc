#include "tools/launch/program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

namespace sinew::launch {

namespace {

using Clock = std::chrono::steady_clock;

int MillisecondsUntil(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  return static_cast<int>(std::max<std::int64_t>(0, left.count()));
}

}  // namespace

Program::Program(const std::vector<std::string>& arguments, const std::string& folder) {
  int out[2], error[2];
  if (::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(error, O_CLOEXEC) != 0 ||
      ::pipe2(wake_fd_, O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("no fork");
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int null = ::open("/dev/null", O_RDONLY);
    ::dup2(null, 0);
    ::dup2(out[1], 1);
    ::dup2(error[1], 2);
    if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(126);
    ::setenv("SINEW_DEPLOYMENT", "none", 1);
    ::execvp(words[0], words.data());
    ::_exit(127);
  }
  ::close(out[1]);
  ::close(error[1]);
  out_fd_ = out[0];
  error_fd_ = error[0];
  reader_ = std::thread([this] { Collect(); });
}

Program::~Program() {
  if (!reaped_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  (void)!::write(wake_fd_[1], "x", 1);  // a grandchild may hold the pipes open
  reader_.join();
  for (const int fd : {out_fd_, error_fd_, wake_fd_[0], wake_fd_[1]}) ::close(fd);
}

void Program::Collect() {
  std::array<pollfd, 3> fds = {pollfd{out_fd_, POLLIN, 0}, pollfd{error_fd_, POLLIN, 0},
                               pollfd{wake_fd_[0], POLLIN, 0}};
  while (fds[0].fd >= 0 || fds[1].fd >= 0) {
    if (::poll(fds.data(), fds.size(), -1) < 0 && errno != EINTR) break;
    if (fds[2].revents != 0) break;
    for (std::size_t i = 0; i < 2; ++i) {
      if (fds[i].fd < 0 || fds[i].revents == 0) continue;
      std::array<char, 4096> buffer;
      const ssize_t count = ::read(fds[i].fd, buffer.data(), buffer.size());
      if (count <= 0) {
        fds[i].fd = -1;
        continue;
      }
      const std::lock_guard lock(mutex_);
      (i == 0 ? out_ : error_).append(buffer.data(), static_cast<std::size_t>(count));
      changed_.notify_all();
    }
  }
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

bool Program::WaitForText(const std::string& text, std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  const auto found = [&] {
    return out_.find(text) != std::string::npos || error_.find(text) != std::string::npos;
  };
  changed_.wait_for(lock, limit, [&] { return found() || closed_; });
  return found();
}

void Program::Signal(int signal) const { ::kill(pid_, signal); }

int Program::Wait(std::chrono::milliseconds limit) {
  const Clock::time_point end = Clock::now() + limit;
  if (!reaped_) {
    const int handle = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
    pollfd fd = {handle, POLLIN, 0};
    while (handle >= 0 && ::poll(&fd, 1, MillisecondsUntil(end)) < 0 && errno == EINTR) {
    }
    if (handle >= 0) ::close(handle);
    if (::waitpid(pid_, &status_, WNOHANG) != pid_) return kTimeout;
    reaped_ = true;
  }
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, end, [this] { return closed_; });
  return WIFSIGNALED(status_) ? -WTERMSIG(status_) : WEXITSTATUS(status_);
}

std::string Program::output() const {
  const std::lock_guard lock(mutex_);
  return out_;
}

std::string Program::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

Finished Run(const std::vector<std::string>& arguments, std::chrono::milliseconds limit) {
  Program program(arguments);
  const int exit_code = program.Wait(limit);
  return {exit_code, program.output(), program.error()};
}

}  // namespace sinew::launch
