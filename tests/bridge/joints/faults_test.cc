// The table of fault rules and the latch, on measurements made by hand.
#include "bridge/joints/faults.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/one_joint.h"

namespace sinew::bridge {
namespace {

constexpr std::int64_t kNow_ns = 10'000 * kMs_ns;

// A joint that is well: everything is of now.
class Rules : public ::testing::Test {
 protected:
  Rules() : config(Knee()), measured(config), encoders(config), fault(config) {
    measured.heartbeat_ns = measured.estimates_ns = measured.iq_ns = measured.output_ns =
        measured.sensors_ns = kNow_ns;
    measured.sensors.motor_temperature_degC = 40.0;
  }
  FaultKind Assess(bool active = true) {
    fault = FaultLatch(config);
    const FaultRule* rule = AssessFaults({.measured = measured,
                                          .timing = timing,
                                          .encoders = encoders,
                                          .active = active,
                                          .now_ns = kNow_ns},
                                         &fault);
    EXPECT_EQ(rule != nullptr, fault.active());
    if (rule != nullptr) {
      EXPECT_EQ(rule->kind, fault.kind());
    }
    return fault.kind();
  }

  JointConfig config;
  BridgeTiming timing;
  JointMeasurement measured;
  EncoderWatch encoders;
  FaultLatch fault;
};

TEST_F(Rules, AJointThatIsWellHasNoFault) {
  EXPECT_EQ(Assess(), FaultKind::kNone);
  EXPECT_TRUE(fault.text().empty());
}

TEST_F(Rules, AxisErrorWithTheNamesOfItsBits) {
  measured.heartbeat.axis_error =
      can::axis_error::kMotorFailed | can::axis_error::kWatchdogTimerExpired;
  EXPECT_EQ(Assess(false), FaultKind::kAxisError);
  EXPECT_EQ(fault.text(),
            "joint 'knee' (node 3): axis error 0x840, motor failed, watchdog expired");
}

// Each time limit: at it nothing, a nanosecond later a fault.
TEST_F(Rules, SilenceBeyondItsTimeLimit) {
  const struct {
    std::int64_t* stamp_ns;
    std::int64_t limit_ns;
    FaultKind kind;
    const char* text;
  } cases[] = {
      {&measured.heartbeat_ns, 350 * kMs_ns, FaultKind::kHeartbeatLost, "no heartbeat"},
      {&measured.estimates_ns, 60 * kMs_ns, FaultKind::kEstimatesLost, "no encoder estimates"},
      {&measured.output_ns, 60 * kMs_ns, FaultKind::kNodeLost, "nothing from the sensor node"},
      {&measured.sensors_ns, 350 * kMs_ns, FaultKind::kNodeLost, "nothing from the sensor node"},
  };
  for (const auto& c : cases) {
    *c.stamp_ns = kNow_ns - c.limit_ns;
    EXPECT_EQ(Assess(), FaultKind::kNone) << c.text;
    *c.stamp_ns -= 1;
    EXPECT_EQ(Assess(), c.kind);
    EXPECT_EQ(Assess(false), c.kind) << "an idle joint as well";
    EXPECT_EQ(fault.text(), std::string("joint 'knee' (node 3): ") + c.text);
    *c.stamp_ns = kNow_ns;
  }
}

TEST_F(Rules, WithoutASensorNodeItsRulesDoNotHold) {
  config.output.reset();
  measured.output_ns = measured.sensors_ns = 0;
  measured.sensors.motor_temperature_degC = 500.0;
  EXPECT_EQ(Assess(), FaultKind::kNone);
}

TEST_F(Rules, TemperatureAboveItsLimit) {
  measured.sensors.motor_temperature_degC = 90.0;
  EXPECT_EQ(Assess(), FaultKind::kNone);
  measured.sensors.motor_temperature_degC = 90.1;
  EXPECT_EQ(Assess(false), FaultKind::kOverTemperature);
}

TEST_F(Rules, OverspeedOfAnActiveJointInBothDirections) {
  // 1.5 * 2 rad/s at the output, 100:1, in turns.
  const double limit_rev_s = 1.5 * 2.0 * 100.0 / types::kTwoPi;
  for (const double sign : {1.0, -1.0}) {
    measured.estimates.velocity_rev_s = 0.999 * sign * limit_rev_s;
    EXPECT_EQ(Assess(), FaultKind::kNone);
    measured.estimates.velocity_rev_s = 1.001 * sign * limit_rev_s;
    EXPECT_EQ(Assess(), FaultKind::kOverspeed);
    EXPECT_EQ(Assess(false), FaultKind::kNone) << "an idle joint may be moved by hand";
  }
}

TEST_F(Rules, AnActiveJointOutsideItsRangeByMoreThanTheMargin) {
  for (const auto& [inside_rad, outside_rad] : {std::pair{1.69, 1.71}, {-1.19, -1.21}}) {
    measured.output.angle_rad = inside_rad;
    EXPECT_EQ(Assess(), FaultKind::kNone);
    measured.output.angle_rad = outside_rad;
    EXPECT_EQ(Assess(), FaultKind::kOutOfRange);
    EXPECT_EQ(Assess(false), FaultKind::kNone);
  }
  (void)Assess();
  EXPECT_EQ(fault.text(), "joint 'knee' (node 3): at -1.210 rad, outside its limits");
}

TEST_F(Rules, TheFirstOfTheTableIsTheCause) {
  measured.heartbeat.axis_error = 1;
  measured.heartbeat_ns = measured.estimates_ns = 0;
  EXPECT_EQ(Assess(), FaultKind::kAxisError);
  measured.heartbeat.axis_error = 0;
  EXPECT_EQ(Assess(), FaultKind::kHeartbeatLost);
  measured.heartbeat_ns = kNow_ns;
  EXPECT_EQ(Assess(), FaultKind::kEstimatesLost);
}

TEST_F(Rules, ALatchedFaultIsNotAssessedAgain) {
  measured.estimates_ns = 0;
  ASSERT_EQ(Assess(), FaultKind::kEstimatesLost);
  measured.heartbeat.axis_error = 1;
  EXPECT_EQ(AssessFaults(
                {.measured = measured, .timing = timing, .encoders = encoders, .now_ns = kNow_ns},
                &fault),
            nullptr);
  EXPECT_EQ(fault.kind(), FaultKind::kEstimatesLost);
}

TEST(FaultRules, EveryKindIsThereOnceAndSilenceNamesTheBus) {
  std::set<FaultKind> kinds;
  for (const FaultRule& rule : FaultRules()) {
    EXPECT_TRUE(kinds.insert(rule.kind).second) << FaultName(rule.kind);
    const bool lost = rule.kind == FaultKind::kHeartbeatLost ||
                      rule.kind == FaultKind::kEstimatesLost || rule.kind == FaultKind::kNodeLost;
    EXPECT_EQ(rule.silence, lost) << FaultName(rule.kind);
  }
  EXPECT_EQ(kinds.size(), 10U);
}

TEST(FaultName, EveryKindHasOneOfItsOwn) {
  std::set<std::string> names;
  for (int kind = 0; kind < kFaultKinds; ++kind) names.insert(FaultName(FaultKind(kind)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kFaultKinds));
  EXPECT_STREQ(FaultName(FaultKind::kNone), "none");
  EXPECT_STREQ(FaultName(FaultKind::kNotFinite), "not finite");
}

TEST(FaultLatch, KeepsTheFirstFault) {
  FaultLatch fault(Knee());
  EXPECT_FALSE(fault.active());
  fault.Fail(FaultKind::kZero, "first");
  fault.Fail(FaultKind::kNotFinite, "second");
  EXPECT_TRUE(fault.active());
  EXPECT_EQ(fault.kind(), FaultKind::kZero);
  EXPECT_EQ(fault.text(), "joint 'knee' (node 3): first");
}

// A fault that nobody has seen must not vanish by a reset that was meant for another one.
TEST(FaultLatch, OnlyAReportedFaultIsCleared) {
  FaultLatch fault(Knee());
  EXPECT_FALSE(fault.ClearReported()) << "nothing is there";
  fault.Fail(FaultKind::kZero, "why");
  EXPECT_FALSE(fault.ClearReported());
  EXPECT_TRUE(fault.active());
  EXPECT_TRUE(fault.Report());
  EXPECT_TRUE(fault.ClearReported());
  EXPECT_FALSE(fault.active());
  EXPECT_TRUE(fault.text().empty());
  fault.Fail(FaultKind::kNotFinite, "new");
  EXPECT_FALSE(fault.ClearReported()) << "a new one is to be reported first";
  EXPECT_TRUE(fault.active());
}

TEST(FaultLatch, ErrorCodesExplainAnAxisErrorOnce) {
  FaultLatch fault(Knee());
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  EXPECT_TRUE(fault.text().empty()) << "no fault to explain";
  fault.Fail(FaultKind::kAxisError, "axis error 0x40");
  fault.AppendErrorCode(ErrorSource::kMotor, 0);
  fault.AppendErrorCode(ErrorSource::kMotor, 0x1000000000);
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  fault.AppendErrorCode(ErrorSource::kEncoder, 0x4);
  fault.AppendErrorCode(ErrorSource::kController, 0x2);
  EXPECT_EQ(fault.text(),
            "joint 'knee' (node 3): axis error 0x40, motor 0x1000000000, encoder 0x4, controller "
            "0x2");
  (void)fault.Report();
  (void)fault.ClearReported();
  fault.Fail(FaultKind::kAxisError, "again");
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  EXPECT_EQ(fault.text(), "joint 'knee' (node 3): again, motor 0x10");
}

TEST(FaultLatch, ErrorCodesDoNotExplainOtherFaults) {
  FaultLatch fault(Knee());
  fault.Fail(FaultKind::kEstimatesLost, "no encoder estimates");
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  EXPECT_EQ(fault.text(), "joint 'knee' (node 3): no encoder estimates");
}

TEST(AxisErrorText, UnknownBitsAreThereAsANumber) {
  EXPECT_EQ(AxisErrorText(0x80000000U), "axis error 0x80000000");
  EXPECT_EQ(AxisErrorText(can::axis_error::kOverTemp | can::axis_error::kEstopRequested),
            "axis error 0x44000, estop requested, over-temperature");
}

}  // namespace
}  // namespace sinew::bridge
