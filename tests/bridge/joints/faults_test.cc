// The table of fault rules and the latch, on measurements made by hand.
#include "bridge/joints/faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/one_joint.h"

namespace sinew::bridge {
namespace {

using ::testing::StartsWith;
using types::FaultCause;

constexpr std::int64_t kNow_ns = 10'000 * kMs_ns;

// A joint that is well: everything is of now.
class Rules : public ::testing::Test {
 protected:
  Rules() : config(Knee()), measured(config), encoders(config), fault(config) {
    measured.heartbeat_ns = measured.estimates_ns = measured.iq_ns = measured.output_ns =
        measured.sensors_ns = kNow_ns;
    measured.sensors.motor_temperature_degC = 40.0;
  }
  FaultCause Assess(bool active = true) {
    fault = FaultLatch(config);
    const FaultRule* rule = AssessFaults({.measured = measured,
                                          .timing = timing,
                                          .encoders = encoders,
                                          .active = active,
                                          .now_ns = kNow_ns},
                                         &fault);
    EXPECT_EQ(rule != nullptr, fault.active());
    if (rule != nullptr) {
      EXPECT_EQ(rule->cause, fault.cause());
    }
    return fault.cause();
  }

  JointConfig config;
  BridgeTiming timing;
  JointMeasurement measured;
  EncoderWatch encoders;
  FaultLatch fault;
};

TEST_F(Rules, AJointThatIsWellHasNoFault) {
  EXPECT_EQ(Assess(), FaultCause::kNone);
  EXPECT_TRUE(fault.text().empty());
}

TEST_F(Rules, AxisErrorWithTheNamesOfItsBits) {
  measured.heartbeat.axis_error =
      can::axis_error::kMotorFailed | can::axis_error::kWatchdogTimerExpired;
  EXPECT_EQ(Assess(false), FaultCause::kAxisError);
  EXPECT_EQ(
      fault.text(),
      "joint 'knee' (node 3): axis error: 0x840, motor failed, watchdog expired: when its cause "
      "is gone, 'sinew reset' clears it");
}

// Each time limit: at it nothing, a nanosecond later a fault.
TEST_F(Rules, SilenceBeyondItsTimeLimit) {
  const struct {
    std::int64_t* stamp_ns;
    std::int64_t limit_ns;
    FaultCause kind;
    const char* text;
  } cases[] = {
      {&measured.heartbeat_ns, 350 * kMs_ns, FaultCause::kHeartbeatLost, "no heartbeat"},
      {&measured.estimates_ns, 60 * kMs_ns, FaultCause::kEstimatesLost, "no encoder estimates"},
      {&measured.output_ns, 60 * kMs_ns, FaultCause::kNodeLost, "nothing from the sensor node"},
      {&measured.sensors_ns, 350 * kMs_ns, FaultCause::kNodeLost, "nothing from the sensor node"},
  };
  for (const auto& c : cases) {
    *c.stamp_ns = kNow_ns - c.limit_ns;
    EXPECT_EQ(Assess(), FaultCause::kNone) << c.text;
    *c.stamp_ns -= 1;
    EXPECT_EQ(Assess(), c.kind);
    EXPECT_EQ(Assess(false), c.kind) << "an idle joint as well";
    const std::string limit_ms = std::to_string(c.limit_ns / kMs_ns);
    EXPECT_THAT(fault.text(),
                StartsWith(std::string("joint 'knee' (node 3): ") + c.text + " for " + limit_ms +
                           " ms, limit " + limit_ms + " ms: is its power"));
    EXPECT_NEAR(fault.fault().value, 1e-6 * static_cast<double>(c.limit_ns + 1), 1e-9);
    *c.stamp_ns = kNow_ns;
  }
}

TEST_F(Rules, WithoutASensorNodeItsRulesDoNotHold) {
  config.output.reset();
  measured.output_ns = measured.sensors_ns = 0;
  measured.sensors.motor_temperature_degC = 500.0;
  EXPECT_EQ(Assess(), FaultCause::kNone);
}

TEST_F(Rules, TemperatureAboveItsLimit) {
  measured.sensors.motor_temperature_degC = 90.0;
  EXPECT_EQ(Assess(), FaultCause::kNone);
  measured.sensors.motor_temperature_degC = 90.1;
  EXPECT_EQ(Assess(false), FaultCause::kOverTemperature);
}

TEST_F(Rules, OverspeedOfAnActiveJointInBothDirections) {
  // 1.5 * 2 rad/s at the output, 100:1, in turns.
  const double limit_rev_s = 1.5 * 2.0 * 100.0 / types::kTwoPi;
  for (const double sign : {1.0, -1.0}) {
    measured.estimates.velocity_rev_s = 0.999 * sign * limit_rev_s;
    EXPECT_EQ(Assess(), FaultCause::kNone);
    measured.estimates.velocity_rev_s = 1.001 * sign * limit_rev_s;
    EXPECT_EQ(Assess(), FaultCause::kOverspeed);
    EXPECT_EQ(Assess(false), FaultCause::kNone) << "an idle joint may be moved by hand";
  }
}

TEST_F(Rules, AnActiveJointOutsideItsRangeByMoreThanTheMargin) {
  for (const auto& [inside_rad, outside_rad] : {std::pair{1.69, 1.71}, {-1.19, -1.21}}) {
    measured.output.angle_rad = inside_rad;
    EXPECT_EQ(Assess(), FaultCause::kNone);
    measured.output.angle_rad = outside_rad;
    EXPECT_EQ(Assess(), FaultCause::kOutOfRange);
    EXPECT_EQ(Assess(false), FaultCause::kNone);
  }
  (void)Assess();
  EXPECT_THAT(fault.text(),
              StartsWith("joint 'knee' (node 3): out of range: -1.21 rad, limit -1.2 rad: "));
}

TEST_F(Rules, TheFirstOfTheTableIsTheCause) {
  measured.heartbeat.axis_error = 1;
  measured.heartbeat_ns = measured.estimates_ns = 0;
  EXPECT_EQ(Assess(), FaultCause::kAxisError);
  measured.heartbeat.axis_error = 0;
  EXPECT_EQ(Assess(), FaultCause::kHeartbeatLost);
  measured.heartbeat_ns = kNow_ns;
  EXPECT_EQ(Assess(), FaultCause::kEstimatesLost);
}

TEST_F(Rules, ALatchedFaultIsNotAssessedAgain) {
  measured.estimates_ns = 0;
  ASSERT_EQ(Assess(), FaultCause::kEstimatesLost);
  measured.heartbeat.axis_error = 1;
  EXPECT_EQ(AssessFaults(
                {.measured = measured, .timing = timing, .encoders = encoders, .now_ns = kNow_ns},
                &fault),
            nullptr);
  EXPECT_EQ(fault.cause(), FaultCause::kEstimatesLost);
}

TEST(FaultRules, EveryKindIsThereOnceAndSilenceNamesTheBus) {
  std::set<FaultCause> kinds;
  for (const FaultRule& rule : FaultRules()) {
    EXPECT_TRUE(kinds.insert(rule.cause).second) << types::TermsOf(rule.cause).name;
    const bool lost = rule.cause == FaultCause::kHeartbeatLost ||
                      rule.cause == FaultCause::kEstimatesLost ||
                      rule.cause == FaultCause::kNodeLost;
    EXPECT_EQ(rule.silence, lost) << types::TermsOf(rule.cause).name;
  }
  EXPECT_EQ(kinds.size(), 10U);
}

TEST(FaultLatch, KeepsTheFirstFault) {
  FaultLatch fault(Knee());
  EXPECT_FALSE(fault.active());
  fault.Fail(FaultCause::kZero, "first");
  fault.Fail(FaultCause::kNotFinite, "second");
  EXPECT_TRUE(fault.active());
  EXPECT_EQ(fault.cause(), FaultCause::kZero);
  EXPECT_THAT(fault.text(), StartsWith("joint 'knee' (node 3): zero check: first: "));
}

// A fault that nobody has seen must not vanish by a reset that was meant for another one.
TEST(FaultLatch, OnlyAReportedFaultIsCleared) {
  FaultLatch fault(Knee());
  EXPECT_FALSE(fault.ClearReported()) << "nothing is there";
  fault.Fail(FaultCause::kZero, "why");
  EXPECT_FALSE(fault.ClearReported());
  EXPECT_TRUE(fault.active());
  EXPECT_TRUE(fault.Report());
  EXPECT_TRUE(fault.ClearReported());
  EXPECT_FALSE(fault.active());
  EXPECT_TRUE(fault.text().empty());
  fault.Fail(FaultCause::kNotFinite, "new");
  EXPECT_FALSE(fault.ClearReported()) << "a new one is to be reported first";
  EXPECT_TRUE(fault.active());
}

TEST(FaultLatch, ErrorCodesExplainAnAxisErrorOnce) {
  FaultLatch fault(Knee());
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  EXPECT_TRUE(fault.text().empty()) << "no fault to explain";
  fault.Fail(FaultCause::kAxisError, "0x40");
  fault.AppendErrorCode(ErrorSource::kMotor, 0);
  fault.AppendErrorCode(ErrorSource::kMotor, 0x1000000000);
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  fault.AppendErrorCode(ErrorSource::kEncoder, 0x4);
  fault.AppendErrorCode(ErrorSource::kController, 0x2);
  EXPECT_THAT(
      fault.text(),
      StartsWith("joint 'knee' (node 3): axis error: 0x40, motor 0x1000000000, encoder 0x4, "
                 "controller 0x2: when its"));
  (void)fault.Report();
  (void)fault.ClearReported();
  fault.Fail(FaultCause::kAxisError, "again");
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  EXPECT_THAT(fault.text(),
              StartsWith("joint 'knee' (node 3): axis error: again, motor 0x10: when its"));
}

TEST(FaultLatch, ErrorCodesDoNotExplainOtherFaults) {
  FaultLatch fault(Knee());
  fault.Fail(FaultCause::kEstimatesLost);
  fault.AppendErrorCode(ErrorSource::kMotor, 0x10);
  EXPECT_THAT(fault.text(), StartsWith("joint 'knee' (node 3): no encoder estimates: is its"));
}

TEST(AxisErrorText, UnknownBitsAreThereAsANumber) {
  EXPECT_EQ(AxisErrorText(0x80000000U), "0x80000000");
  EXPECT_EQ(AxisErrorText(can::axis_error::kOverTemp | can::axis_error::kEstopRequested),
            "0x44000, estop requested, over-temperature");
}

}  // namespace
}  // namespace sinew::bridge
