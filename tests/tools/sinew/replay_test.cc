// `sinew replay` and `replay-control` as processes: pause, steps, jumps, loops, keys. Domain 206.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sinew_idl/joint.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>
#include <utmp.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "components/topics/node/node.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ReplayClock = std::chrono::steady_clock;
using ::testing::HasSubstr;

constexpr char kReplayDomain[] = "206";
constexpr auto kReplayLimit = 30s;
constexpr int kRows = 2500;  // 10 s of a recording at 250 Hz

class Replay : public ::testing::Test {
 protected:
  Replay() {
    const std::string map = folder_.Write(
        "map.yaml",
        "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\nsignals:\n"
        "  position: {column: q, unit: rad}\n  motor_current: {column: i, unit: A}\n");
    std::string csv = "t,q,i\n";
    for (int row = 0; row < kRows; ++row) {
      csv += std::to_string(row * 0.004) + "," + std::to_string(0.001 * row) + ",0.5\n";
    }
    recording_ = (folder_.path() / "run.mcap").string();
    const Finished import = testing::Run(
        {kSinew, "import", folder_.Write("data.csv", csv), "--map", map, "--out", recording_});
    EXPECT_EQ(import.exit_code, 0) << import.error;
    node::Options options;
    options.component = options.name = "observer";
    options.domain_id = std::stoi(kReplayDomain);
    node_.emplace(options);
    states_.emplace(node_->MakeReader(node::kJointState));
  }

  std::vector<std::string> Line(const std::vector<std::string>& more) const {
    std::vector<std::string> line{kSinew, "replay", recording_, "--domain", kReplayDomain};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }

  // The player's state after a request.
  nlohmann::json Control(const std::vector<std::string>& request) const {
    std::vector<std::string> line{kSinew,        "replay-control", "--domain",
                                  kReplayDomain, "--json",         "replay"};
    line.insert(line.end(), request.begin(), request.end());
    const Finished run = testing::Run(line);
    EXPECT_EQ(run.exit_code, 0) << run.error;
    return nlohmann::json::accept(run.output) ? nlohmann::json::parse(run.output)
                                              : nlohmann::json::object();
  }
  // Until the player is there and past its wait for readers.
  bool WaitUntilItPlays() const {
    const auto end = ReplayClock::now() + kReplayLimit;
    while (ReplayClock::now() < end) {
      const Finished run = testing::Run(
          {kSinew, "replay-control", "--domain", kReplayDomain, "--json", "replay", "status"});
      if (run.exit_code == 0 && nlohmann::json::parse(run.output)["waiting"] == 0) return true;
    }
    return false;
  }
  // The states that come until the tick, or within the limit.
  std::vector<msg::JointState> StatesUntil(std::uint64_t tick) {
    std::vector<msg::JointState> states;
    const auto end = ReplayClock::now() + kReplayLimit;
    while (ReplayClock::now() < end) {
      const auto state = states_->WaitNext(200ms);
      if (!state) continue;
      states.push_back(*state);
      if (state->header.tick == tick) break;
    }
    return states;
  }

  TemporaryFolder folder_;
  std::string recording_;
  std::optional<node::Node> node_;
  std::optional<node::Reader<msg::JointState>> states_;
};

TEST_F(Replay, PausedItSendsAsManyTicksAsAreAskedFor) {
  Program replay(Line({"--paused"}));
  ASSERT_TRUE(WaitUntilItPlays()) << replay.error();
  EXPECT_EQ(Control({"status"})["messages"], 0);
  // Joint_state and actuator_state of each tick.
  const auto one = Control({"step"});
  EXPECT_EQ(one["paused"], 1);
  EXPECT_EQ(one["tick"], 0);
  EXPECT_EQ(one["messages"], 2);
  const auto five = Control({"step", "5"});
  EXPECT_EQ(five["tick"], 5);
  EXPECT_EQ(five["messages"], 12);
  const auto states = StatesUntil(5);
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states.back().header.tick, 5u);
  EXPECT_EQ(states.back().header.origin, msg::Origin::kReplay);
  EXPECT_EQ(Control({"quit"})["paused"], 1);
  EXPECT_EQ(replay.Wait(kReplayLimit), 0) << replay.error();
}

TEST_F(Replay, AJumpBackIsANewSession) {
  Program replay(Line({"--paused"}));
  ASSERT_TRUE(WaitUntilItPlays()) << replay.error();
  const auto far = Control({"seek", "8"});
  EXPECT_NEAR(far["position_s"].get<double>(), 8.0, 1e-6);
  const auto late = Control({"step"});
  EXPECT_EQ(late["tick"], 2000);
  Control({"seek", "1.5"});
  const auto early = Control({"step"});
  EXPECT_EQ(early["tick"], 375);
  EXPECT_NE(early["session_id"], late["session_id"]);
  EXPECT_EQ(early["pass"], 2);
  const Finished beyond =
      testing::Run({kSinew, "replay-control", "--domain", kReplayDomain, "replay", "seek", "1000"});
  EXPECT_EQ(beyond.exit_code, 1);
  EXPECT_THAT(beyond.error, HasSubstr("expected 0 to 9.996"));
  replay.Signal(SIGINT);
  EXPECT_EQ(replay.Wait(kReplayLimit), 0) << replay.error();
}

TEST_F(Replay, EveryLoopIsASessionWithTicksThatGrow) {
  states_.reset();  // another time mode: no reader in this process
  node_.reset();
  Program replay(Line({"--rate", "max", "--loop", "3", "--lockstep", "--json"}));
  Program record({kSinew, "record", "--lockstep", "--domain", kReplayDomain, "--keep-going",
                  "--topics", "joint_state", "--out", (folder_.path() / "copy.mcap").string(),
                  "--duration", "25", "--json"});
  ASSERT_EQ(replay.Wait(kReplayLimit), 0) << replay.error();
  const auto result = nlohmann::json::parse(replay.output());
  EXPECT_EQ(result["messages"], 3 * 2 * kRows);
  EXPECT_EQ(result["of"], 3 * 2 * kRows);
  EXPECT_NEAR(result["recorded_s"].get<double>(), 3 * 9.996, 1e-3);
  record.Signal(SIGINT);
  ASSERT_EQ(record.Wait(kReplayLimit), 0) << record.error();
  const Finished hz =
      testing::Run({kSinew, "hz", "--from", (folder_.path() / "copy.mcap").string(), "--json"});
  ASSERT_EQ(hz.exit_code, 0) << hz.error;
  const auto rates = nlohmann::json::parse(hz.output);
  ASSERT_EQ(rates.size(), 1u);
  EXPECT_EQ(rates[0]["sessions"], 3);
  EXPECT_EQ(rates[0]["messages"], 3 * kRows);
  EXPECT_EQ(rates[0]["lost"], 0);
  EXPECT_EQ(rates[0]["repeated"], 0);
}

TEST_F(Replay, TheRateCanBeChangedWhileItPlays) {
  Program replay(Line({"--rate", "0.1"}));
  ASSERT_TRUE(WaitUntilItPlays()) << replay.error();
  EXPECT_EQ(Control({"rate", "2"})["rate"], 2);
  EXPECT_EQ(Control({"faster"})["rate"], 5);
  EXPECT_EQ(Control({"rate", "max"})["rate"], "max");
  EXPECT_EQ(replay.Wait(kReplayLimit), 0) << replay.error();  // at 0.1 it would take 100 s
}

TEST_F(Replay, WrongRequestsAreOneLine) {
  const auto expect = [](const std::vector<std::string>& line, const std::string& what) {
    const Finished run = testing::Run(line);
    EXPECT_EQ(run.exit_code, 2) << run.error;
    EXPECT_THAT(run.error, HasSubstr(what));
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
  };
  expect({kSinew, "replay-control", "--domain", kReplayDomain, "nobody", "pause"},
         "no player answers at");
  expect({kSinew, "replay-control", "--domain", kReplayDomain, "replay", "fly"},
         "'fly', expected pause");
  expect(Line({"--rate", "0.01"}), "at least 0.1, or max");
  expect(Line({"--topics", "("}), "no regular expression");
}

// A terminal of its own for the program.
class OnTerminal {
 public:
  explicit OnTerminal(const std::vector<std::string>& line) {
    std::vector<char*> arguments;
    arguments.reserve(line.size() + 1);
    for (const std::string& word : line) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    // The slave stays open here, so that its settings outlive the program.
    char name[128] = {};
    EXPECT_EQ(::openpty(&master_, &slave_, name, nullptr, nullptr), 0);
    EXPECT_EQ(::tcgetattr(slave_, &before_), 0);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::login_tty(slave_);
      ::close(master_);
      ::execv(arguments[0], arguments.data());
      ::_exit(127);
    }
    (void)::fcntl(master_, F_SETFL, O_NONBLOCK);
  }
  ~OnTerminal() {
    if (!ended_) {
      (void)::kill(pid_, SIGKILL);
      (void)::waitpid(pid_, nullptr, 0);
    }
    ::close(master_);
    ::close(slave_);
  }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  void Type(const std::string& keys) const {
    EXPECT_EQ(::write(master_, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  }
  // Until the text is on the screen, since the last time that this was called.
  bool WaitForScreen(const std::string& text) {
    return Until([&] {
      Read();
      const std::size_t at = screen_.find(text);
      if (at == std::string::npos) return false;
      screen_.erase(0, at + text.size());
      return true;
    });
  }
  // Echo and whole lines, as before the program. By the master: the end of the program hangs the
  // slave up.
  bool IsAsBefore() const {
    termios now{};
    return ::tcgetattr(master_, &now) == 0 && now.c_lflag == before_.c_lflag;
  }
  void Signal(int signal) const { (void)::kill(pid_, signal); }
  // Exit code, or -signal.
  int Wait() {
    int status = 0;
    ended_ = Until([&] {
      Read();
      return ::waitpid(pid_, &status, WNOHANG) == pid_;
    });
    if (!ended_) return -1000;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  const std::string& screen() const { return screen_; }

 private:
  template <class Condition>
  bool Until(Condition condition) const {
    const auto end = ReplayClock::now() + kReplayLimit;
    while (ReplayClock::now() < end) {
      if (condition()) return true;
      pollfd waiting{master_, POLLIN, 0};  // output, or the end of the program
      (void)::poll(&waiting, 1, 20);
    }
    return false;
  }
  void Read() {
    char bytes[4096];
    ssize_t size = 0;
    while ((size = ::read(master_, bytes, sizeof(bytes))) > 0) {
      screen_.append(bytes, static_cast<std::size_t>(size));
    }
  }

  int master_ = -1, slave_ = -1;
  pid_t pid_ = 0;
  bool ended_ = false;
  termios before_{};
  std::string screen_;
};

TEST_F(Replay, KeysPauseAndStepAndTheTerminalIsRestored) {
  OnTerminal replay(Line({"--rate", "0.1"}));
  ASSERT_TRUE(replay.WaitForScreen(" x0.1")) << replay.screen();
  EXPECT_FALSE(replay.IsAsBefore());
  replay.Type(" ");
  ASSERT_TRUE(replay.WaitForScreen(" x0.1 paused")) << replay.screen();
  replay.Type("s+");
  ASSERT_TRUE(replay.WaitForScreen(" x0.2 paused")) << replay.screen();
  replay.Type("\x1b[C");
  ASSERT_TRUE(replay.WaitForScreen("pass 1")) << replay.screen();
  replay.Type("q");
  EXPECT_EQ(replay.Wait(), 0) << replay.screen();
  EXPECT_TRUE(replay.IsAsBefore());
}

TEST_F(Replay, TheTerminalIsRestoredWhateverEndsIt) {
  for (const int signal : {SIGINT, SIGABRT, SIGHUP}) {
    OnTerminal replay(Line({"--paused"}));
    ASSERT_TRUE(replay.WaitForScreen("paused")) << replay.screen();
    ASSERT_FALSE(replay.IsAsBefore());
    replay.Signal(signal);
    EXPECT_EQ(replay.Wait(), signal == SIGINT ? 0 : -signal) << replay.screen();
    EXPECT_TRUE(replay.IsAsBefore()) << "signal " << signal;
  }
}

}  // namespace
}  // namespace sinew::testing
