// A player's socket: request and answer, refusals, a socket that is left behind.
#include "components/record/logger/player/control_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <atomic>
#include <string>
#include <thread>

#include "components/base/config/config.h"
#include "tests/support/skip.h"
#include "tests/support/strange_socket.h"
#include "tests/support/temporary_folder.h"

namespace sinew::logger {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

// Replies to everything with its kind, as a player would.
class Replier {
 public:
  explicit Replier(PlayControl& control) : control_(control), thread_([this] { Run(); }) {}
  ~Replier() {
    stop_ = true;
    thread_.join();
  }

 private:
  void Run() {
    PlayRequest request;
    while (!stop_) {
      control_.WaitForRequest(10ms);
      while (control_.Next(&request)) {
        control_.Reply(request.kind == PlayRequest::Kind::kSeek
                           ? "error seek: expected 0 to 10"
                           : "ok ticks=" + std::to_string(request.ticks));
      }
    }
  }

  PlayControl& control_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST(ControlSocket, AnswersEachRequestWithOneLine) {
  const testing::TemporaryFolder folder;
  PlayControl control;
  const Replier replier(control);
  const ControlSocket socket(folder.path() / "p.sock", control);
  EXPECT_EQ(AskPlayer(socket.path(), "step 7", 10s), "ok ticks=7");
  EXPECT_EQ(AskPlayer(socket.path(), "seek 12", 10s), "error seek: expected 0 to 10");
  EXPECT_THAT(AskPlayer(socket.path(), "fly", 10s), HasSubstr("error 'fly', expected pause"));
  EXPECT_THAT(AskPlayer(socket.path(), std::string(3000, 'x'), 10s), HasSubstr("error '"));
}

TEST(ControlSocket, IsForTheSameUserAlone) {
  const testing::TemporaryFolder folder;
  PlayControl control;
  const ControlSocket socket(folder.path() / "p.sock", control);
  struct stat info {};
  ASSERT_EQ(::stat(socket.path().c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0600u);
}

TEST(ControlSocket, ASecondPlayerIsRefusedAndALeftSocketIsTakenOver) {
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "p.sock";
  PlayControl control;
  {
    const ControlSocket socket(path, control);
    PlayControl other;
    EXPECT_THROW(ControlSocket(path, other), UsageError);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  folder.Write("p.sock", "no socket");
  PlayControl third;
  EXPECT_THROW(ControlSocket(path, third), UsageError);
  EXPECT_TRUE(std::filesystem::exists(path)) << "a file of somebody else must stay";
}

TEST(ControlSocket, WithoutAPlayerTheClientSaysWhereItLooked) {
  const testing::TemporaryFolder folder;
  try {
    (void)AskPlayer(folder.path() / "none.sock", "pause", 1s);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no player answers at " + folder.path().string()));
  }
}

TEST(ControlSocket, AnotherUsersSocketInItsPlaceIsNoPlayer) {
  SKIP_WITHOUT_KERNEL(::geteuid() == 0, "second user for this one");
  const testing::TemporaryFolder folder;
  const auto path = folder.path() / "p.sock";
  const config::Descriptor stranger = testing::ListenAs(testing::kStranger, path);
  try {
    (void)AskPlayer(path, "pause", 1s);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr(path.string() + ": user 65534 answers, expected 0"));
  }
}

TEST(ControlSocket, NamesOfParticipantsBecomeNamesOfFiles) {
  EXPECT_THAT(PlayerSocket(7, "left/leg 1").filename().string(),
              HasSubstr("player-7-left_leg_1.sock"));
  EXPECT_NE(PlayerSocket(7, "a"), PlayerSocket(8, "a"));
}

}  // namespace
}  // namespace sinew::logger
