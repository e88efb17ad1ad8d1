#include "tools/launch/launcher.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/process/args.hpp>
#include <boost/process/async_pipe.hpp>
#include <boost/process/child.hpp>
#include <boost/process/env.hpp>
#include <boost/process/error.hpp>
#include <boost/process/exe.hpp>
#include <boost/process/extend.hpp>
#include <boost/process/io.hpp>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <iomanip>
#include <memory>
#include <sstream>
#include <system_error>

#include "components/base/types/seconds.h"
#include "tools/launch/process_end.h"

namespace sinew::launch {

namespace {

namespace asio = boost::asio;
namespace bp = boost::process;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kKeptLines = 8;  // of each stream, printed when a process fails
constexpr std::chrono::milliseconds kDrain(
    500);  // for output still in the pipes of an ended process

std::string Seconds(double seconds) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << seconds << " s";
  return out.str();
}

// Ends of a pipe must not leak into processes started later: they would keep it open.
void CloseOnExec(bp::async_pipe* pipe) {
  ::fcntl(pipe->native_source(), F_SETFD, FD_CLOEXEC);
  ::fcntl(pipe->native_sink(), F_SETFD, FD_CLOEXEC);
}

// Work of the child between fork and exec; only async-signal-safe calls.
struct PrepareChild {
  pid_t parent;
  template <class Executor>
  void operator()(Executor&) const {
    ::setpgid(0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);     // an end in order; SINEW_LAUNCHER is the other way
    if (::getppid() != parent) ::_exit(1);  // it died before prctl
    ::signal(SIGPIPE, SIG_DFL);
  }
};

class Launcher {
 public:
  enum class State { kWaiting, kRunning, kExited, kBackingOff, kEnded };

  struct Stream {
    explicit Stream(asio::io_context& context) : pipe(context) {}
    bp::async_pipe pipe;
    std::array<char, 4096> buffer{};
    std::unique_ptr<LineSplitter> splitter;
    std::deque<std::string> kept;
    bool open = false;
  };

  struct Child {
    const Process* process = nullptr;
    std::size_t index = 0;
    State state = State::kWaiting;
    pid_t pid = 0;
    int status = 0;
    bool ready = false;
    int restarts = 0;
    Clock::time_point started;
    std::array<std::shared_ptr<Stream>, 2> streams;  // output, error
    std::unique_ptr<asio::steady_timer> timer;       // drain, or back-off
  };

  // One group of processes is asked to stop at a time: provider, the others, those that stop last.
  enum class Phase { kRunning, kSettling, kProvider, kOthers, kLast };

  Launcher(const Deployment& d, Output& o)
      : deployment(d), output(o), signals(context), phase_timer(context) {
    for (std::size_t i = 0; i < deployment.processes.size(); ++i) {
      auto child = std::make_unique<Child>();
      child->process = &deployment.processes[i];
      child->index = i;
      child->timer = std::make_unique<asio::steady_timer>(context);
      children.push_back(std::move(child));
    }
  }

  ~Launcher() {
    for (auto& child : children) {
      if (child->state != State::kRunning) continue;
      ::kill(-child->pid, SIGKILL);
      ::waitpid(child->pid, nullptr, 0);
    }
  }

  Result Run() {
    ::signal(SIGPIPE, SIG_IGN);
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGHUP, SIGCHLD}) signals.add(signal);
    WaitForSignal();
    const Clock::time_point start = Clock::now();
    StartReady();
    context.run();
    result.duration_s = std::chrono::duration<double>(Clock::now() - start).count();
    return result;
  }

  void WaitForSignal() {
    signals.async_wait([this](const boost::system::error_code& error, int signal) {
      if (error) return;
      if (signal == SIGCHLD) {
        ReapAll();
      } else {
        OnStopSignal(signal);
      }
      if (!AllEnded()) WaitForSignal();
    });
  }

  // --- starting

  void StartReady() {
    for (auto& child : children) {
      if (phase != Phase::kRunning) return;  // one of them failed at once
      if (child->state != State::kWaiting) continue;
      if (std::all_of(child->process->after.begin(), child->process->after.end(),
                      [this](const std::string& name) { return IsReady(name); })) {
        Start(child.get());
      }
    }
  }

  bool IsReady(const std::string& name) const {
    for (const auto& child : children) {
      if (child->process->name == name) return child->ready || child->state == State::kEnded;
    }
    return true;
  }

  void Start(Child* child) {
    const std::vector<std::string> line = CommandLine(deployment, *child->process, child->restarts);
    for (std::size_t i = 0; i < 2; ++i) {
      auto stream = std::make_shared<Stream>(context);
      stream->splitter = std::make_unique<LineSplitter>(
          [this, child, i](std::string_view text) { OnLine(child, i, text); });
      CloseOnExec(&stream->pipe);
      child->streams[i] = std::move(stream);
    }
    std::error_code error;
    bp::child process(
        bp::exe = line.front(), bp::args = std::vector<std::string>(line.begin() + 1, line.end()),
        bp::std_in<bp::null, bp::std_out> child->streams[0]->pipe,
        bp::std_err > child->streams[1]->pipe,
        bp::env["SINEW_DEPLOYMENT"] = deployment.isolated ? deployment.name : std::string("none"),
        bp::env["SINEW_LAUNCHER"] = std::to_string(::getpid()),
        bp::extend::on_exec_setup = PrepareChild{::getpid()}, error);
    if (error) {
      child->state = State::kEnded;
      Fail(child, "cannot be started: " + error.message());
      return;
    }
    child->pid = process.id();
    process.detach();                   // waited for here, by pid
    ::setpgid(child->pid, child->pid);  // as the child does: whoever comes first
    child->state = State::kRunning;
    child->started = Clock::now();
    for (auto& stream : child->streams) {
      stream->open = true;
      Read(child, stream);
    }
  }

  // --- output

  void Read(Child* child, const std::shared_ptr<Stream>& stream) {
    stream->pipe.async_read_some(
        asio::buffer(stream->buffer),
        [this, child, stream](const boost::system::error_code& error, std::size_t count) {
          stream->splitter->Add(std::string_view(stream->buffer.data(), count));
          if (!error) {
            Read(child, stream);
            return;
          }
          stream->splitter->Finish();
          stream->open = false;
          boost::system::error_code ignored;
          stream->pipe.close(ignored);
          if (child->state == State::kExited && !Draining(*child)) Settle(child);
        });
  }

  bool Draining(const Child& child) const {
    return child.streams[0]->open || child.streams[1]->open;
  }

  void OnLine(Child* child, std::size_t stream_index, std::string_view text) {
    auto& kept = child->streams[stream_index]->kept;
    kept.emplace_back(text);
    if (kept.size() > kKeptLines) kept.pop_front();
    output.FromProcess(child->index, stream_index == 1, text);
    if (output.broken() && phase == Phase::kRunning) {
      output.Say("the output is closed, stopping");
      StopAll();
    }
    if (!child->ready && text.find(child->process->ready_when) != std::string_view::npos) {
      child->ready = true;
      asio::post(context, [this] { StartReady(); });
    }
  }

  // --- ending

  void ReapAll() {
    for (auto& child : children) {
      if (child->state != State::kRunning) continue;
      siginfo_t info{};
      const auto id = static_cast<id_t>(child->pid);
      if (::waitid(P_PID, id, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == 0)
        continue;
      ::kill(-child->pid, SIGKILL);  // what it left behind; its own id is still taken
      ::waitpid(child->pid, &child->status, 0);
      child->state = State::kExited;
      if (!Draining(*child)) {
        Settle(child.get());
        continue;
      }
      child->timer->expires_after(kDrain);
      child->timer->async_wait([this, c = child.get()](const boost::system::error_code& error) {
        if (error || c->state != State::kExited) return;
        for (auto& stream : c->streams) {
          boost::system::error_code ignored;
          if (stream->open) stream->pipe.close(ignored);
          stream->open = false;
        }
        Settle(c);
      });
    }
  }

  // A process has ended and all its output is out: restart, end of session, or failure.
  void Settle(Child* child) {
    child->timer->cancel();
    const Process& process = *child->process;
    const bool is_provider = process.name == deployment.provider;
    const ProcessEnd end{.status = child->status,
                         .deployment_stops = phase != Phase::kRunning,
                         .asked_to_stop = phase > Phase::kSettling,
                         .is_provider = is_provider,
                         .restarts = child->restarts};
    const bool failed = Failed(end);
    if (StartsAgain(process, end)) {
      BackOff(child, failed);
      return;
    }
    child->state = State::kEnded;
    if (failed) {
      const double age_s = std::chrono::duration<double>(Clock::now() - child->started).count();
      std::string cause = CauseOf(child->status) + " after " + Seconds(age_s);
      if (end.asked_to_stop) cause += ", while stopping";
      if (child->restarts > 0) {
        cause += ", restarted " + std::to_string(child->restarts) + " times before";
      }
      Fail(child, cause);
    } else if (is_provider && phase == Phase::kRunning) {
      phase = Phase::kSettling;
      output.Say("session ended: " + process.name + " is done");
      phase_timer.expires_after(types::ToNanoseconds(deployment.grace_s));
      phase_timer.async_wait([this](const boost::system::error_code& error) {
        if (!error && phase == Phase::kSettling) StopAll();
      });
    }
    if (phase == Phase::kRunning) StartReady();
    NextPhaseIfDone();
    FinishIfDone();
  }

  void BackOff(Child* child, bool failed) {
    const double wait_s = BackOff_s(*child->process, child->restarts);
    ++child->restarts;
    ++result.restarts;
    child->state = State::kBackingOff;
    output.Say(child->process->name + (failed ? " failed: " : " ended: ") + CauseOf(child->status) +
               "; restart " + std::to_string(child->restarts) + " of " +
               std::to_string(child->process->max_restarts) + " in " + Seconds(wait_s));
    child->timer->expires_after(types::ToNanoseconds(wait_s));
    child->timer->async_wait([this, child](const boost::system::error_code& error) {
      if (error || child->state != State::kBackingOff) return;
      if (phase == Phase::kRunning) {
        Start(child);
      } else {
        child->state = State::kEnded;
        FinishIfDone();
      }
    });
  }

  void Fail(Child* child, const std::string& cause) {
    Failure failure{child->process->name, cause, {}};
    if (child->streams[0] != nullptr) {
      const auto& kept =
          !child->streams[1]->kept.empty() ? child->streams[1]->kept : child->streams[0]->kept;
      failure.last_lines.assign(kept.begin(), kept.end());
    }
    const bool ends_all =
        child->process->vital && (phase == Phase::kRunning || phase == Phase::kSettling);
    output.Say(failure.process + " failed: " + cause +
               (child->process->vital || phase != Phase::kRunning ? "" : "; the others go on"));
    result.failures.push_back(std::move(failure));
    if (ends_all) StopAll();
  }

  // --- stopping

  void OnStopSignal(int signal) {
    ++stop_signals;
    if (stop_signals == 1) {
      result.stopped_by_user = true;
      output.Say(std::string(strsignal(signal)) + ": stopping (again to hurry)");
      if (phase == Phase::kRunning || phase == Phase::kSettling) StopAll();
      return;
    }
    hurry = stop_signals == 2 ? SIGTERM : SIGKILL;
    for (auto& child : children) {
      if (child->state == State::kRunning) ::kill(-child->pid, hurry);
    }
  }

  void StopAll() {
    for (auto& child : children) {
      if (child->state == State::kWaiting) child->state = State::kEnded;
      if (child->state == State::kBackingOff) {
        child->state = State::kEnded;
        child->timer->cancel();
      }
    }
    phase = Phase::kProvider;
    BeginPhase();
    FinishIfDone();
  }

  bool InPhase(const Child& child) const {
    const bool is_provider = child.process->name == deployment.provider;
    switch (phase) {
      case Phase::kProvider:
        return is_provider;
      case Phase::kOthers:
        return !is_provider && !child.process->stop_last;
      case Phase::kLast:
        return !is_provider && child.process->stop_last;
      default:
        return false;
    }
  }

  bool PhaseDone() const {
    return std::none_of(children.begin(), children.end(), [this](const auto& child) {
      return InPhase(*child) && child->state != State::kEnded;
    });
  }

  void SignalPhase(int signal) {
    for (auto& child : children) {
      if (InPhase(*child) && child->state == State::kRunning) ::kill(-child->pid, signal);
    }
  }

  void BeginPhase() {
    SignalPhase(hurry != 0 ? hurry : SIGINT);
    Escalate(hurry != 0 ? hurry : SIGINT);
    NextPhaseIfDone();
  }

  void Escalate(int last_signal) {
    const int next = last_signal == SIGINT ? SIGTERM : SIGKILL;
    phase_timer.expires_after(types::ToNanoseconds(deployment.grace_s));
    phase_timer.async_wait([this, next](const boost::system::error_code& error) {
      if (error) return;
      for (auto& child : children) {
        if (InPhase(*child) && child->state == State::kRunning) {
          output.Say(child->process->name +
                     " does not stop: " + (next == SIGTERM ? "SIGTERM" : "SIGKILL"));
        }
      }
      SignalPhase(next);
      if (next != SIGKILL) Escalate(next);
    });
  }

  void NextPhaseIfDone() {
    while (phase > Phase::kSettling && phase < Phase::kLast && PhaseDone()) {
      phase_timer.cancel();
      phase = phase == Phase::kProvider ? Phase::kOthers : Phase::kLast;
      SignalPhase(hurry != 0 ? hurry : SIGINT);
      Escalate(hurry != 0 ? hurry : SIGINT);
    }
  }

  bool AllEnded() const {
    return std::all_of(children.begin(), children.end(),
                       [](const auto& child) { return child->state == State::kEnded; });
  }

  void FinishIfDone() {
    if (!AllEnded()) return;
    phase_timer.cancel();
    signals.cancel();
    for (auto& child : children) child->timer->cancel();
  }

  const Deployment& deployment;
  Output& output;
  asio::io_context context;
  asio::signal_set signals;
  asio::steady_timer phase_timer;
  std::vector<std::unique_ptr<Child>> children;
  Phase phase = Phase::kRunning;
  int stop_signals = 0;
  int hurry = 0;  // signal that the user's second or third Ctrl-C asks for
  Result result;
};

}  // namespace

Result RunDeployment(const Deployment& deployment, Output& output) {
  return Launcher(deployment, output).Run();
}

}  // namespace sinew::launch
