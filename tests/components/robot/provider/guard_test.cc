#include "components/robot/provider/guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "components/base/types/robot_state.h"

namespace sinew::provider {
namespace {

using types::FaultCause;

constexpr std::uint64_t kSession = 42;
constexpr std::chrono::nanoseconds kPeriod{4166667};  // 240 Hz: 60 ms are 14.4 periods

types::MessageHeader Head(std::uint64_t tick, types::Origin origin = types::Origin::kSim) {
  return {.session_id = kSession, .tick = tick, .origin = origin};
}

CommandGuard Armed(GuardConfig config = {}) {
  CommandGuard guard(config);
  guard.StartSession(kSession);
  EXPECT_TRUE(guard.Arm(kSession, 0));
  return guard;
}

TEST(Guard, StartsDisarmedAndLetsNothingThrough) {
  CommandGuard guard({});
  guard.StartSession(kSession);
  EXPECT_TRUE(guard.Offer(Head(0), 0));
  EXPECT_EQ(guard.Step(0, kPeriod), Verdict::kIdle);
  EXPECT_EQ(guard.state(), types::RobotState::kDisarmed);
}

TEST(Guard, PassesAFreshCommandOfItsOwnSession) {
  CommandGuard guard = Armed();
  EXPECT_EQ(guard.Step(0, kPeriod), Verdict::kIdle) << "armed, but nothing was commanded yet";
  EXPECT_TRUE(guard.Offer(Head(1), 1));
  EXPECT_EQ(guard.Step(1, kPeriod), Verdict::kPass);
}

TEST(Guard, RefusesOtherSessionsTheFutureRepeatsAndOldCommands) {
  CommandGuard guard = Armed();
  EXPECT_FALSE(
      guard.Offer({.session_id = kSession + 1, .tick = 1, .origin = types::Origin::kSim}, 1));
  EXPECT_FALSE(guard.Offer(Head(2), 1));
  EXPECT_TRUE(guard.Offer(Head(1), 1));
  EXPECT_FALSE(guard.Offer(Head(1), 1));
  EXPECT_FALSE(guard.Offer(Head(0), 1));
  EXPECT_EQ(guard.refused(), 4u);
}

TEST(Guard, ACommandIsAsOldAsTheClockSaysWhenTicksSayLess) {
  using std::chrono::milliseconds;
  CommandGuard guard = Armed();
  EXPECT_TRUE(guard.Offer(Head(1), 1));
  EXPECT_EQ(guard.Step(1, kPeriod, milliseconds(3)), Verdict::kPass);
  EXPECT_EQ(guard.Step(1, kPeriod, milliseconds(16)), Verdict::kPass) << "3.8 periods with its own";
  EXPECT_EQ(guard.Step(1, kPeriod, milliseconds(17)), Verdict::kDamp);
  EXPECT_EQ(guard.Step(1, kPeriod, milliseconds(64)), Verdict::kDamp);
  EXPECT_EQ(guard.state(), types::RobotState::kDamped);
  EXPECT_EQ(guard.Step(1, kPeriod, milliseconds(65)), Verdict::kIdle);
  EXPECT_EQ(guard.state(), types::RobotState::kFault);
}

TEST(Guard, ACommandIsAsOldAsTicksSayWhenTheClockSaysLess) {
  CommandGuard guard = Armed();
  EXPECT_TRUE(guard.Offer(Head(1), 1));
  EXPECT_EQ(guard.Step(4, kPeriod, std::chrono::milliseconds(1)), Verdict::kDamp);
}

TEST(Guard, OnLiveHardwareOnlyLiveCommandsCount) {
  GuardConfig config;
  config.live = true;
  CommandGuard guard = Armed(config);
  EXPECT_FALSE(guard.Offer(Head(1, types::Origin::kSim), 1));
  EXPECT_FALSE(guard.Offer(Head(1, types::Origin::kReplay), 1));
  EXPECT_TRUE(guard.Offer(Head(1, types::Origin::kLive), 1));
}

TEST(Guard, BridgesAfterThreeMissedPeriodsAndFaultsAfterSixtyMilliseconds) {
  CommandGuard guard = Armed();
  ASSERT_TRUE(guard.Offer(Head(10), 10));
  EXPECT_EQ(guard.Step(12, kPeriod), Verdict::kPass) << "two missed";
  EXPECT_EQ(guard.Step(13, kPeriod), Verdict::kDamp) << "three";
  EXPECT_EQ(guard.state(), types::RobotState::kDamped);
  EXPECT_EQ(guard.Step(24, kPeriod), Verdict::kDamp);  // 58.3 ms
  EXPECT_EQ(guard.Step(25, kPeriod), Verdict::kIdle);  // 62.5 ms
  EXPECT_EQ(guard.state(), types::RobotState::kFault);
  EXPECT_EQ(guard.faults(), 1u);
  EXPECT_EQ(guard.fault().cause, FaultCause::kCommandMissing);
  EXPECT_NEAR(guard.fault().value, 62.5, 0.01);
  EXPECT_EQ(guard.fault().limit, 60.0);
}

TEST(Guard, KeepsTheFirstCauseUntilReset) {
  CommandGuard guard = Armed();
  EXPECT_EQ(guard.fault().cause, FaultCause::kNone);
  guard.Fail({.cause = FaultCause::kCycleLate, .value = 80.0, .limit = 60.0});
  guard.Fail({FaultCause::kPlant});
  guard.JointFault({FaultCause::kOverspeed});
  EXPECT_EQ(guard.fault().cause, FaultCause::kCycleLate);
  ASSERT_TRUE(guard.Reset());
  EXPECT_EQ(guard.fault().cause, FaultCause::kNone);
}

TEST(Guard, AFreshCommandEndsTheBridgeButNotTheFault) {
  CommandGuard guard = Armed();
  ASSERT_TRUE(guard.Offer(Head(10), 10));
  ASSERT_EQ(guard.Step(14, kPeriod), Verdict::kDamp);
  ASSERT_TRUE(guard.Offer(Head(15), 15));
  EXPECT_EQ(guard.Step(15, kPeriod), Verdict::kPass);
  EXPECT_EQ(guard.state(), types::RobotState::kArmed);
  ASSERT_EQ(guard.Step(40, kPeriod), Verdict::kIdle);
  EXPECT_TRUE(guard.Offer(Head(41), 41));
  EXPECT_EQ(guard.Step(41, kPeriod), Verdict::kIdle);
  EXPECT_EQ(guard.state(), types::RobotState::kFault);
}

TEST(Guard, AFaultNeedsResetAndThenArming) {
  CommandGuard guard = Armed();
  guard.Fail({FaultCause::kPlant});
  EXPECT_FALSE(guard.Arm(kSession, 50));
  EXPECT_TRUE(guard.Reset());
  EXPECT_EQ(guard.state(), types::RobotState::kDisarmed);
  EXPECT_TRUE(guard.Arm(kSession, 50));
  EXPECT_EQ(guard.Step(51, kPeriod), Verdict::kIdle) << "commands from before arming do not count";
  EXPECT_TRUE(guard.Offer(Head(51), 51));
  EXPECT_EQ(guard.Step(51, kPeriod), Verdict::kPass);
}

TEST(Guard, AJointsFaultIdlesTheOthersUnlessConfiguredOtherwise) {
  const auto after = [](OtherJointsPolicy policy) {
    CommandGuard guard = Armed({.on_joint_fault = policy});
    EXPECT_TRUE(guard.Offer(Head(1), 1));
    EXPECT_EQ(guard.Step(1, kPeriod), Verdict::kPass);
    guard.JointFault({FaultCause::kOverspeed});
    EXPECT_EQ(guard.state() == types::RobotState::kFault, policy != OtherJointsPolicy::kContinue);
    EXPECT_TRUE(guard.Offer(Head(2), 2));  // counted, and used only while armed
    return guard.Step(2, kPeriod);
  };
  EXPECT_EQ(after(OtherJointsPolicy::kIdle), Verdict::kIdle);
  EXPECT_EQ(after(OtherJointsPolicy::kDamp), Verdict::kDamp);
  EXPECT_EQ(after(OtherJointsPolicy::kHold), Verdict::kHold);
  EXPECT_EQ(after(OtherJointsPolicy::kContinue), Verdict::kPass);
}

TEST(Guard, HoldingTheOtherJointsEndsByDisarmEstopResetOrAFaultOfAll) {
  const auto after = [](void (*end)(CommandGuard*)) {
    CommandGuard guard = Armed({.on_joint_fault = OtherJointsPolicy::kHold});
    guard.JointFault({FaultCause::kOverspeed});
    EXPECT_EQ(guard.Step(500, kPeriod), Verdict::kHold) << "no command is waited for";
    end(&guard);
    return guard.Step(501, kPeriod);
  };
  EXPECT_EQ(after([](CommandGuard* guard) { guard->Disarm(); }), Verdict::kIdle);
  EXPECT_EQ(after([](CommandGuard* guard) { guard->Estop(); }), Verdict::kIdle);
  EXPECT_EQ(after([](CommandGuard* guard) { guard->Fail({FaultCause::kPlant}); }), Verdict::kIdle);
  EXPECT_EQ(after([](CommandGuard* guard) { EXPECT_TRUE(guard->Reset()); }), Verdict::kIdle);
}

TEST(Guard, AJointsFaultWhileDisarmedHoldsNothing) {
  CommandGuard guard({.on_joint_fault = OtherJointsPolicy::kHold});
  guard.StartSession(kSession);
  guard.JointFault({FaultCause::kOverspeed});
  EXPECT_EQ(guard.Step(1, kPeriod), Verdict::kIdle);
}

TEST(Guard, AFallIsAFaultInWhichTheJointsIdleOrAreDamped) {
  const auto after = [](FallPolicy policy, void (*before)(CommandGuard*)) {
    CommandGuard guard = Armed({.on_joint_fault = OtherJointsPolicy::kHold, .on_fall = policy});
    before(&guard);
    guard.Fall();
    EXPECT_EQ(guard.state(), types::RobotState::kFault);
    return guard.Step(500, kPeriod);
  };
  const auto nothing = [](CommandGuard*) {};
  EXPECT_EQ(after(FallPolicy::kIdle, nothing), Verdict::kIdle);
  EXPECT_EQ(after(FallPolicy::kDamp, nothing), Verdict::kDamp);
  const auto joint_fault = [](CommandGuard* guard) { guard->JointFault({FaultCause::kOverspeed}); };
  EXPECT_EQ(after(FallPolicy::kIdle, joint_fault), Verdict::kIdle) << "the others held until then";
  EXPECT_EQ(after(FallPolicy::kDamp, joint_fault), Verdict::kDamp);
  const auto disarm = [](CommandGuard* guard) { guard->Disarm(); };
  EXPECT_EQ(after(FallPolicy::kDamp, disarm), Verdict::kIdle) << "nothing moved";
}

TEST(Guard, EstopIsLatchedAndStrongerThanAFault) {
  CommandGuard guard = Armed();
  guard.Estop();
  guard.Fail({FaultCause::kPlant});
  EXPECT_EQ(guard.state(), types::RobotState::kEstopped);
  EXPECT_FALSE(guard.Arm(kSession, 1));
  guard.Disarm();
  EXPECT_EQ(guard.state(), types::RobotState::kEstopped);
  EXPECT_TRUE(guard.Reset());
}

TEST(Guard, ArmingIsBoundToTheSession) {
  CommandGuard guard({});
  guard.StartSession(kSession);
  EXPECT_FALSE(guard.Arm(kSession + 1, 0));
  EXPECT_EQ(guard.state(), types::RobotState::kDisarmed);
}

TEST(Guard, RefusesLimitsThatAreNotPositive) {
  GuardConfig config;
  config.missed_periods = 0;
  EXPECT_THROW(CommandGuard{config}, std::invalid_argument);
  config = {};
  config.fault_after = std::chrono::milliseconds(0);
  EXPECT_THROW(CommandGuard{config}, std::invalid_argument);
  config = {};
  config.damping_Nm_s_rad = std::nan("");
  EXPECT_THROW(CommandGuard{config}, std::invalid_argument);
}

}  // namespace
}  // namespace sinew::provider
