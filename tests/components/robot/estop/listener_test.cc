#include "components/robot/estop/listener.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <condition_variable>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>

#include "components/base/config/unix_socket.h"
#include "components/robot/estop/press.h"
#include "components/robot/estop/socket_folder.h"
#include "tests/support/own_folders.h"
#include "tests/support/skip.h"
#include "tests/support/strange_socket.h"
#include "tests/support/temporary_folder.h"

namespace sinew::estop {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

// A listener and what it calls; this test's thread plays the cycle.
class Desk {
 public:
  explicit Desk(const Config& config)
      : listener(config, {.wake = [this] { Wake(); },
                          .report =
                              [this](bool is_error, const std::string& text) {
                                const std::lock_guard lock(mutex_);
                                (is_error ? errors_ : notes_) += text + "\n";
                                changed_.notify_all();
                              }}) {}

  // Waits at most 10 s for a condition of the cycle.
  template <class Condition>
  bool Until(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 10s, condition);
  }
  // Plays the cycle until a press has been taken and idled.
  bool TakeAndIdle() {
    if (!Until([this] { return listener.TakePress(); })) return false;
    listener.IdleSent(listener.taken());
    listener.IdleConfirmed(listener.taken());
    return true;
  }
  std::string errors() {
    const std::lock_guard lock(mutex_);
    return errors_;
  }

 private:
  void Wake() {
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string errors_, notes_;

 public:
  Listener listener;
};

Config In(const testing::TemporaryFolder& folder) {
  Config config;
  config.socket = folder.path() / "socket";
  config.latch = folder.path() / "latch";
  return config;
}

TEST(EstopListener, APressIsIdleThenLatched) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  EXPECT_FALSE(desk.listener.TakePress());
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(press.sent()) << press.error();
  ASSERT_TRUE(desk.TakeAndIdle());
  const Press::Answer answer = press.Await(10s);
  EXPECT_EQ(answer.text, "idle\nlatched\n");
  EXPECT_TRUE(answer.idle);
  EXPECT_TRUE(answer.latched);
  EXPECT_EQ(LatchFile(folder.path() / "latch").Read().why, "socket: hand");
  EXPECT_FALSE(desk.listener.TakePress()) << "one press is taken once";
}

TEST(EstopListener, NothingIsWrittenBeforeTheIdleFramesAreSent) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(desk.Until([&] { return desk.listener.TakePress(); }));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "latch"));
  desk.listener.IdleSent(desk.listener.taken());
  EXPECT_TRUE(press.Await(10s).latched);
}

TEST(EstopListener, ACycleThatHangsDoesNotKeepTheLatchFromTheDisk) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  Press press(folder.path() / "socket", "hand");
  const Press::Answer answer = press.Await(10s);
  EXPECT_EQ(answer.text,
            "idle not confirmed: the state provider's cycle does not answer\nlatched\n");
  EXPECT_FALSE(answer.idle);
  EXPECT_TRUE(LatchFile(folder.path() / "latch").Read().latched);
  EXPECT_TRUE(desk.listener.TakePress()) << "and the cycle finds it when it is back";
}

TEST(EstopListener, FramesThatWereSentAreNotIdleBeforeTheAxesReportIt) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(desk.Until([&] { return desk.listener.TakePress(); }));
  desk.listener.IdleSent(desk.listener.taken());
  // The latch does not wait for the axes.
  EXPECT_TRUE(desk.Until([&] { return LatchFile(folder.path() / "latch").Read().valid; }));
  const Press::Answer answer = press.Await(10s);
  EXPECT_FALSE(answer.idle);
  EXPECT_THAT(answer.text, HasSubstr("its frames were sent, the axes do not report it"));
  EXPECT_TRUE(answer.latched);
}

TEST(EstopListener, AResetBeforeTheAnswerIsNotUndoneByIt) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(desk.Until([&] { return desk.listener.TakePress(); }));
  desk.listener.IdleSent(desk.listener.taken());
  ASSERT_TRUE(desk.Until([&] { return LatchFile(folder.path() / "latch").Read().valid; }));
  desk.listener.RequestUnlatch();
  ASSERT_TRUE(desk.Until([&] { return desk.listener.unlatch() == Listener::Unlatch::kDone; }));
  (void)press.Await(10s);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "latch"));
}

TEST(EstopListener, AnythingWrittenIsAPressAndAConnectionAloneIsNone) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  const auto address = *config::SocketAddress(folder.path() / "socket");
  const auto connect = [&] {
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return socket;
  };
  const int silent = connect();
  ::close(silent);
  const int waits = connect();
  const int writes = connect();
  EXPECT_EQ(::send(writes, "\0", 1, MSG_NOSIGNAL), 1);
  ::close(writes);  // and does not wait for an answer
  ASSERT_TRUE(desk.TakeAndIdle());
  EXPECT_EQ(desk.listener.taken(), 1U) << "the silent ones pressed nothing";
  EXPECT_EQ(::send(waits, "x", 1, MSG_NOSIGNAL), 1);
  ASSERT_TRUE(desk.TakeAndIdle());
  ::close(waits);
}

TEST(EstopListener, ManyConnectionsDoNotKeepAPressOut) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  std::vector<Press> presses;
  const auto address = *config::SocketAddress(folder.path() / "socket");
  std::vector<int> silent;
  for (int i = 0; i < 100; ++i) {
    silent.push_back(::socket(AF_UNIX, SOCK_STREAM, 0));
    ASSERT_EQ(::connect(silent.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(press.sent()) << press.error();
  ASSERT_TRUE(desk.TakeAndIdle());
  EXPECT_TRUE(press.Await(10s).idle);
  for (const int socket : silent) ::close(socket);
}

TEST(EstopListener, AnEstopOfAnotherWayIsKeptInTheSameFileAndRemovedByAReset) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  desk.listener.Latch("by DDS");
  desk.listener.RequestUnlatch();  // at once: the file may never have been there
  ASSERT_TRUE(desk.Until([&] { return desk.listener.unlatch() == Listener::Unlatch::kDone; }));
  EXPECT_FALSE(LatchFile(folder.path() / "latch").Read().latched);

  desk.listener.Latch("by DDS");
  ASSERT_TRUE(desk.Until([&] { return LatchFile(folder.path() / "latch").Read().latched; }));
  EXPECT_EQ(LatchFile(folder.path() / "latch").Read().why, "by DDS");
}

TEST(EstopListener, AnEstopDuringAResetLeavesTheLatch) {
  const testing::TemporaryFolder folder;
  Desk desk(In(folder));
  for (int i = 0; i < 50; ++i) {
    desk.listener.RequestUnlatch();
    desk.listener.Latch("again");
    // Done is the newer one of the two.
    ASSERT_TRUE(desk.Until([&] { return desk.listener.unlatch() == Listener::Unlatch::kFailed; }));
    EXPECT_TRUE(LatchFile(folder.path() / "latch").Read().latched);
  }
}

TEST(EstopListener, ALatchThatIsThereAtTheStartStays) {
  const testing::TemporaryFolder folder;
  const Config config = In(folder);
  ASSERT_EQ(LatchFile(*config.latch).Write("yesterday"), "");
  {
    const Desk desk(config);
    EXPECT_TRUE(desk.listener.at_start().latched);
    EXPECT_EQ(desk.listener.at_start().why, "yesterday");
  }
  EXPECT_TRUE(LatchFile(*config.latch).Read().latched);
}

TEST(EstopListener, ALatchThatCannotBeWrittenIsReportedAndWrittenLater) {
  const testing::TemporaryFolder folder;
  Config config = In(folder);
  config.latch = folder.path() / "later" / "latch";
  Desk desk(config);
  EXPECT_TRUE(desk.listener.at_start().latched) << "no folder: not known, so stopped";
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(desk.TakeAndIdle());
  const Press::Answer answer = press.Await(10s);
  EXPECT_TRUE(answer.idle);
  EXPECT_FALSE(answer.latched);
  EXPECT_THAT(answer.text, HasSubstr("not latched: "));
  EXPECT_THAT(desk.errors(), HasSubstr("not after a restart"));
  std::filesystem::create_directory(folder.path() / "later");
  EXPECT_TRUE(desk.Until([&] { return LatchFile(*config.latch).Read().latched; }));
}

TEST(EstopListener, AResetThatCannotRemoveTheLatchFails) {
  const testing::TemporaryFolder folder;
  Config config = In(folder);
  std::filesystem::create_directory(*config.latch);
  Desk desk(config);
  EXPECT_TRUE(desk.listener.at_start().latched);
  desk.listener.RequestUnlatch();
  EXPECT_TRUE(desk.Until([&] { return desk.listener.unlatch() == Listener::Unlatch::kFailed; }));
}

TEST(EstopListener, TheSocketIsForOwnerAndGroup) {
  const testing::TemporaryFolder folder;
  Config config = In(folder);
  struct stat info {};
  {
    const Desk desk(config);
    ASSERT_EQ(::stat(config.socket->c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 0777, 0660U);
  }
  EXPECT_FALSE(std::filesystem::exists(*config.socket));
  config.socket_mode = 0600;
  const Desk desk(config);
  ASSERT_EQ(::stat(config.socket->c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600U);
}

TEST(EstopListener, TakesTheSocketOfOneThatWasKilledAndNotOfOneThatLives) {
  const testing::TemporaryFolder folder;
  const Config config = In(folder);
  const auto address = *config::SocketAddress(*config.socket);
  const int killed = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(killed, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(killed);
  const Desk first(config);
  Config other = config;
  other.latch.reset();
  try {
    const Desk second(other);
    FAIL() << "two at one socket";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another process answers there"));
  }
  EXPECT_TRUE(std::filesystem::exists(*config.socket));
  Config file = other;
  file.socket = folder.Write("file", "precious");
  EXPECT_THROW(Desk{file}, UsageError);
  EXPECT_TRUE(std::filesystem::exists(*file.socket)) << "what is no socket is left alone";
}

TEST(EstopListener, AnAnswerOfAnotherUserDoesNotCountAndHisSocketIsPressed) {
  SKIP_WITHOUT_KERNEL(::geteuid() == 0, "second user for this one");
  const testing::TemporaryFolder folder;
  const config::Descriptor stranger =
      testing::ListenAs(testing::kStranger, folder.path() / "socket");
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(press.sent()) << press.error();
  const config::Descriptor client(::accept4(stranger.get(), nullptr, nullptr, SOCK_CLOEXEC));
  char text[16] = {};
  EXPECT_EQ(::recv(client.get(), text, sizeof text, 0), 5) << "the robot's stop comes first";
  EXPECT_EQ(::send(client.get(), "idle\nlatched\n", 13, MSG_NOSIGNAL), 13);
  const Press::Answer answer = press.Await(10s);
  EXPECT_FALSE(answer.idle || answer.latched);
  EXPECT_THAT(answer.text, HasSubstr("does not count: user 65534 listens there"));
  // He may answer in a folder of his own: whoever presses there has named it.
  ASSERT_EQ(::chown(folder.path().c_str(), testing::kStranger, static_cast<gid_t>(-1)), 0);
  Press own(folder.path() / "socket", "hand");
  config::Descriptor second(::accept4(stranger.get(), nullptr, nullptr, SOCK_CLOEXEC));
  EXPECT_EQ(::send(second.get(), "idle\nlatched\n", 13, MSG_NOSIGNAL), 13);
  second.Close();
  EXPECT_TRUE(own.Await(10s).idle);
}

TEST(EstopListener, InAFolderThatOthersMayWriteToNobodyListensAndNoAnswerCounts) {
  const testing::TemporaryFolder folder;
  const Config config = In(folder);
  const auto refusal = [&config]() -> std::string {
    try {
      const Desk desk(config);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  {
    Desk desk(config);
    ASSERT_EQ(::chmod(folder.path().c_str(), 01777), 0);
    Press press(*config.socket, "hand");
    ASSERT_TRUE(desk.TakeAndIdle()) << "it is pressed all the same";
    EXPECT_FALSE(press.Await(10s).idle);
  }
  EXPECT_THAT(refusal(), HasSubstr("others may write to its folder"));
  ASSERT_EQ(::chmod(folder.path().c_str(), 0755), 0);
  EXPECT_EQ(refusal(), "");
  if (::geteuid() != 0) return;
  ASSERT_EQ(::chown(folder.path().c_str(), testing::kStranger, static_cast<gid_t>(-1)), 0);
  EXPECT_THAT(refusal(), HasSubstr("its folder belongs to user 65534"));
}

TEST(EstopListener, ASocketOfAnotherUserKeepsNoBridgeFromStarting) {
  SKIP_WITHOUT_KERNEL(::geteuid() == 0, "second user for this one");
  const testing::TemporaryFolder folder;
  const config::Descriptor stranger =
      testing::ListenAs(testing::kStranger, folder.path() / "socket");
  Desk desk(In(folder));
  EXPECT_THAT(desk.errors(), HasSubstr("a socket of user 65534 was there, it is replaced"));
  Press press(folder.path() / "socket", "hand");
  ASSERT_TRUE(desk.TakeAndIdle());
  EXPECT_TRUE(press.Await(10s).idle);
  EXPECT_EQ(desk.listener.presser().user, 0U);
  EXPECT_EQ(desk.listener.presser().process, ::getpid());
}

TEST(EstopListener, TwoStateProvidersDoNotKeepTheirEstopInOneFile) {
  const testing::TemporaryFolder folder;
  const Desk first(In(folder));
  Config second = In(folder);
  second.socket = folder.path() / "second";
  EXPECT_THROW(Desk{second}, UsageError);
  second.latch = folder.path() / "second.latch";
  const Desk other(second);
}

// Every descriptor that the process may have, until it ends.
class NoDescriptors {
 public:
  NoDescriptors() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit few{128, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
    for (int next = ::dup(0); next >= 0; next = ::dup(0)) taken_.emplace_back(next);
    EXPECT_EQ(errno, EMFILE);
  }
  ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
  std::vector<config::Descriptor> taken_;
};

TEST(EstopListener, WithoutFreeDescriptorsAPressIsTakenAndTheThreadSleeps) {
  const testing::TemporaryFolder folder;
  const auto address = *config::SocketAddress(folder.path() / "socket");
  std::vector<config::Descriptor> clients;
  for (int i = 0; i < 3; ++i) clients.emplace_back(::socket(AF_UNIX, SOCK_STREAM, 0));
  const auto connect = [&](std::size_t client) {
    return ::connect(clients[client].get(), reinterpret_cast<const sockaddr*>(&address),
                     sizeof address);
  };
  const auto press = [&](std::size_t client) {
    return connect(client) == 0 && ::send(clients[client].get(), "x", 1, MSG_NOSIGNAL) == 1;
  };
  Desk desk(In(folder));
  {
    const NoDescriptors none;
    ASSERT_EQ(connect(0), 0);  // says nothing, and gives way
    ASSERT_TRUE(press(1));
    ASSERT_TRUE(desk.Until([&] { return desk.listener.TakePress(); }));
    // The next one waits for the place of the first, which gets its answer after 0.4 s.
    const std::clock_t begin = std::clock();
    ASSERT_TRUE(press(2));
    ASSERT_TRUE(desk.Until([&] { return desk.listener.TakePress(); }));
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.1);
    desk.listener.IdleSent(desk.listener.taken());
  }
  EXPECT_TRUE(desk.Until([&] { return LatchFile(folder.path() / "latch").Read().valid; }));
}

TEST(EstopConfig, HardwareHasSocketAndLatchByDefaultAndASimulationNeither) {
  const config::Section none =
      config::Section::Parse("schema: t/1\n", "f.yaml", "t/1").ChildOrEmpty("estop");
  EXPECT_FALSE(LoadConfig(none, "can-bridge", 7, false).socket);
  EXPECT_FALSE(LoadConfig(none, "can-bridge", 7, false).latch);
  SKIP_WITHOUT_KERNEL(testing::HasOwnFolders({"/run", "/var/lib"}), "mounts for this user");
  const Config live = LoadConfig(none, "left/leg", 7, true);
  ASSERT_TRUE(live.socket && live.latch);
  EXPECT_EQ(*live.socket, "/run/sinew/estop-left_leg-7.sock");
  EXPECT_EQ(*live.latch, "/var/lib/sinew/estop-left_leg.latch") << "in whichever domain";
  struct stat info {};
  ASSERT_EQ(::stat("/run/sinew", &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0755U);
}

TEST(EstopConfig, TheSocketOfAUserIsInTheFolderOfHisLoginWhateverHisShellSays) {
  SKIP_WITHOUT_KERNEL(testing::HasOwnFolders({"/run", "/var/lib"}), "mounts for this user");
  ASSERT_EQ(::setenv("XDG_RUNTIME_DIR", "/tmp", 1), 0);
  ASSERT_EQ(::setresuid(testing::kStranger, testing::kStranger, 0), 0);
  const auto socket = [] { return DefaultSocket("can-bridge", 7); };
  try {
    (void)socket();
    ADD_FAILURE() << "no folder, no login";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("sudo install -d -o 65534 /run/sinew"));
  }
  ASSERT_EQ(::setresuid(0, 0, 0), 0);
  std::filesystem::create_directories("/run/user/65534");
  ASSERT_EQ(::chown("/run/user/65534", testing::kStranger, testing::kStranger), 0);
  ASSERT_EQ(::setresuid(testing::kStranger, testing::kStranger, 0), 0);
  EXPECT_EQ(socket(), "/run/user/65534/sinew/estop-can-bridge-7.sock");
  ASSERT_EQ(::setresuid(0, 0, 0), 0);
  EXPECT_EQ(socket(), "/run/sinew/estop-can-bridge-7.sock") << "root's";
  ASSERT_EQ(::unsetenv("XDG_RUNTIME_DIR"), 0);
}

TEST(EstopConfig, AClientPressesEverySocketOfTheFolderOrThoseOfADomain) {
  SKIP_WITHOUT_KERNEL(testing::HasOwnFolders({"/run", "/var/lib"}), "mounts for this user");
  std::filesystem::create_directory("/run/sinew");
  for (const char* name : {"estop-a-7.sock", "estop-b-17.sock", "player-7-a.sock"}) {
    std::ofstream(std::string("/run/sinew/") + name) << "";
  }
  using Paths = std::vector<std::filesystem::path>;
  EXPECT_EQ(SocketsToPress({}, 7), Paths{"/run/sinew/estop-a-7.sock"});
  EXPECT_EQ(SocketsToPress({}, std::nullopt).size(), 2U);
  EXPECT_EQ(SocketsToPress({"other"}, 7), Paths{"other"});
}

TEST(EstopConfig, RefusesWhatIsNotSafe) {
  const auto load = [](const std::string& block) {
    return LoadConfig(
        config::Section::Parse("schema: t/1\nestop: " + block + "\n", "/etc/x/f.yaml", "t/1")
            .Child("estop"),
        "can-bridge", 0, true);
  };
  EXPECT_THROW((void)load("{latch: none}"), UsageError);
  EXPECT_THROW((void)load("{socket_mode: \"0990\"}"), UsageError);
  EXPECT_THROW((void)load("{socket_mode: \"0060\"}"), UsageError);
  EXPECT_THROW((void)load("{sockets: none}"), UsageError);
  const Config config = load("{socket: a.sock, latch: /b/latch, socket_mode: \"0600\"}");
  EXPECT_EQ(*config.socket, "/etc/x/a.sock") << "relative to the file";
  EXPECT_EQ(*config.latch, "/b/latch");
  EXPECT_EQ(config.socket_mode, 0600U);
}

}  // namespace
}  // namespace sinew::estop
