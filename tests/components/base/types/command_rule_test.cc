// The rule against its table, written down a second time.
#include "components/base/types/command_rule.h"

#include <gtest/gtest.h>

#include <string>

namespace sinew::types {
namespace {

constexpr std::uint64_t kRunning = 7;
constexpr Origin kOrigins[] = {Origin::kLive, Origin::kSim, Origin::kReplay};

CommandRefusal Of(CommandKind kind, Origin message, Origin running,
                  std::uint64_t session_id = kRunning) {
  return RefusalOf(kind, {.session_id = session_id, .origin = message}, {kRunning, running});
}

TEST(CommandRule, TheRunningSessionsTable) {
  constexpr auto kYes = CommandRefusal::kNone, kNo = CommandRefusal::kOrigin;
  struct Case {
    CommandKind kind;
    Origin running;
    CommandRefusal live, sim, replay;  // messages of that origin
  };
  constexpr Case kTable[] = {
      {CommandKind::kStop, Origin::kLive, kYes, kYes, kYes},
      {CommandKind::kStop, Origin::kSim, kYes, kYes, kYes},
      {CommandKind::kStop, Origin::kReplay, kYes, kYes, kYes},
      {CommandKind::kRequest, Origin::kLive, kYes, kNo, kNo},
      {CommandKind::kRequest, Origin::kSim, kYes, kYes, kYes},
      {CommandKind::kRequest, Origin::kReplay, kYes, kYes, kYes},
      {CommandKind::kPermission, Origin::kLive, kYes, kNo, kNo},
      {CommandKind::kPermission, Origin::kSim, kYes, kYes, kNo},
      {CommandKind::kPermission, Origin::kReplay, kYes, kYes, kNo},
  };
  for (const Case& c : kTable) {
    SCOPED_TRACE("kind " + std::to_string(static_cast<int>(c.kind)) + ", session of origin " +
                 std::to_string(static_cast<int>(c.running)));
    EXPECT_EQ(Of(c.kind, Origin::kLive, c.running), c.live);
    EXPECT_EQ(Of(c.kind, Origin::kSim, c.running), c.sim);
    EXPECT_EQ(Of(c.kind, Origin::kReplay, c.running), c.replay);
  }
}

TEST(CommandRule, OfAnotherSessionOnlyStopsCount) {
  for (const Origin message : kOrigins) {
    for (const Origin running : kOrigins) {
      EXPECT_EQ(Of(CommandKind::kStop, message, running, 8), CommandRefusal::kNone);
      EXPECT_EQ(Of(CommandKind::kRequest, message, running, 8), CommandRefusal::kOtherSession);
      EXPECT_EQ(Of(CommandKind::kPermission, message, running, 8), CommandRefusal::kOtherSession);
    }
  }
}

TEST(CommandRule, KindsOfAnOperatorsActions) {
  EXPECT_EQ(KindOf(OperatorAction::kDisarm), CommandKind::kStop);
  EXPECT_EQ(KindOf(OperatorAction::kEstop), CommandKind::kStop);
  EXPECT_EQ(KindOf(OperatorAction::kStart), CommandKind::kRequest);
  EXPECT_EQ(KindOf(OperatorAction::kStop), CommandKind::kRequest);
  EXPECT_EQ(KindOf(OperatorAction::kArm), CommandKind::kPermission);
  EXPECT_EQ(KindOf(OperatorAction::kReset), CommandKind::kPermission);
  EXPECT_EQ(KindOf(OperatorAction::kHandover), CommandKind::kPermission);
  EXPECT_EQ(KindOf(OperatorAction::kPermitReplay), CommandKind::kPermission);
}

TEST(CommandRule, EachRefusalHasAText) {
  EXPECT_STREQ(RefusalText(CommandRefusal::kNone), "");
  EXPECT_STRNE(RefusalText(CommandRefusal::kOrigin), "");
  EXPECT_STRNE(RefusalText(CommandRefusal::kOtherSession), "");
}

}  // namespace
}  // namespace sinew::types
