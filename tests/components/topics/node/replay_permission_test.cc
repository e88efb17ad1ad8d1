// The permission to replay, event by event.
#include "components/topics/node/replay_permission.h"

#include <gtest/gtest.h>

namespace sinew::node {
namespace {

constexpr std::uint64_t kSessionNow = 7;
constexpr types::MessageHeader kLiveOperator{.session_id = kSessionNow,
                                             .origin = types::Origin::kLive};
constexpr WriterId kPlayer{1}, kSecondPlayer{2}, kReferenceWriter{3};

class Permission : public testing::Test {
 protected:
  Permission() { Armed(); }
  void Armed() { permission.Cycle({kSessionNow, types::Origin::kLive}, true); }
  // Given, and the player is heard.
  void Given() {
    ASSERT_EQ(permission.Give(kLiveOperator, "player"), "");
    permission.Heard(kPlayer, "player");
    ASSERT_TRUE(permission.Allows(kPlayer));
  }
  ReplayPermission permission;
};

TEST_F(Permission, WithoutItNobodysReplayCounts) {
  permission.Heard(kPlayer, "player");
  EXPECT_FALSE(permission.Allows(kPlayer));
  EXPECT_FALSE(permission.Allows(WriterId{})) << "nor that of a writer that is not known";
}

TEST_F(Permission, HoldsForTheNamedWriterOnly) {
  Given();
  EXPECT_FALSE(permission.Allows(kSecondPlayer));
  EXPECT_FALSE(permission.Allows(kReferenceWriter));
}

TEST_F(Permission, IsRefusedWithTheReason) {
  struct Case {
    types::MessageHeader header;
    const char* name;
    const char* why;
  };
  const Case cases[] = {
      {{.session_id = kSessionNow + 1, .origin = types::Origin::kLive}, "player", "session"},
      {{.session_id = kSessionNow, .origin = types::Origin::kReplay}, "player", "recording"},
      {{.session_id = kSessionNow, .origin = types::Origin::kSim}, "player", "simulation"},
      {kLiveOperator, "", "nobody"}};
  for (const Case& c : cases) {
    EXPECT_NE(permission.Give(c.header, c.name).find(c.why), std::string::npos) << c.why;
    permission.Heard(kPlayer, "player");
    EXPECT_FALSE(permission.Allows(kPlayer)) << c.why;
  }
  permission.Cycle({kSessionNow, types::Origin::kLive}, false);
  EXPECT_NE(permission.Give(kLiveOperator, "player").find("armed"), std::string::npos);
  EXPECT_FALSE(permission.holds());
}

TEST_F(Permission, EndsWithDisarmFaultAndEstop) {  // in none of them may the robot move
  Given();
  permission.Cycle({kSessionNow, types::Origin::kLive}, false);
  EXPECT_FALSE(permission.Allows(kPlayer));
  Armed();
  permission.Heard(kPlayer, "player");
  EXPECT_FALSE(permission.Allows(kPlayer)) << "arming again gives none";
}

TEST_F(Permission, EndsWithTheSession) {
  Given();
  permission.Cycle({kSessionNow + 1, types::Origin::kLive}, true);
  EXPECT_FALSE(permission.Allows(kPlayer));
  EXPECT_NE(permission.ended().find("session"), std::string::npos);
}

TEST_F(Permission, EndsWhenAnotherWriterIsHeard) {
  Given();
  permission.Heard(kReferenceWriter, "reference");
  EXPECT_FALSE(permission.Allows(kPlayer));
  EXPECT_NE(permission.ended().find("'reference'"), std::string::npos);
  permission.Heard(kPlayer, "player");
  EXPECT_FALSE(permission.Allows(kPlayer)) << "and does not come back with the player";
}

TEST_F(Permission, EndsWhenASecondWriterOfThatNameIsHeard) {
  Given();
  permission.Heard(kSecondPlayer, "player");
  EXPECT_FALSE(permission.Allows(kPlayer));
  EXPECT_FALSE(permission.Allows(kSecondPlayer)) << "a restarted player is another one";
}

TEST_F(Permission, SaidAgainChangesNothing) {
  Given();
  EXPECT_EQ(permission.Give(kLiveOperator, "player"), "");
  EXPECT_TRUE(permission.Allows(kPlayer));
  EXPECT_EQ(permission.Give(kLiveOperator, "other"), "");
  EXPECT_FALSE(permission.Allows(kPlayer)) << "for another one it is a new permission";
}

}  // namespace
}  // namespace sinew::node
