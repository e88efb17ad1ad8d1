// A joint made by formula: the model's own balance solved for the current, with more of a term than
// the model says from some time on.
#include "components/robot/residual/monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::residual {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;

actuator::JointModel SomeModel(types::JointKind kind = types::JointKind::kRevolute) {
  actuator::JointModel model;
  model.name = "joint";
  model.kind = kind;
  model.constants = {.gear_ratio = 100.0, .link_length_m = 0.3, .torque_constant_Nm_A = 0.016};
  const auto add = [&](const char* effect, double value) {
    model.terms.push_back(actuator::MakeTerm(effect, model.constants));
    model.terms.back().linear[0].value = value;
  };
  add("drive_current", 0.77);
  add("inertia", 0.13);
  add("viscous", 0.31);
  add("coulomb", 0.22);
  if (kind == types::JointKind::kRevolute) add("gravity", 0.58);
  return model;
}

class Robot {
 public:
  explicit Robot(const actuator::JointModel& model) : truth(model), random_(3) {}

  JointReading At(double time_s) {
    effects::JointSample x;
    x.position_rad = amplitude * std::sin(w * time_s);
    x.velocity_rad_s = amplitude * w * std::cos(w * time_s);
    x.acceleration_rad_s2 = -w * w * x.position_rad;
    x.motor_position_rad = 100.0 * x.position_rad;
    x.motor_velocity_rad_s = 100.0 * x.velocity_rad_s;
    x.motor_acceleration_rad_s2 = 100.0 * x.acceleration_rad_s2;
    return {.valid = true,
            .position_rad = x.position_rad,
            .motor_position_rad = x.motor_position_rad,
            .drive_input = truth.RequiredDriveInput(x, {}) + 0.03 * normal_(random_)};
  }

  actuator::JointModel truth;
  double amplitude = 0.5, w = 2.5;

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

TEST(Monitor, LearnsWatchesAndReportsAPayload) {
  const actuator::JointModel model = SomeModel();
  Robot robot(model);
  robot.truth.terms[2].linear[0].value = 0.35;  // the specimen is not the model
  Monitor monitor(model, {}, kPeriod_s);
  bool reported_learning = false;
  double reported_s = 0.0;
  MonitorOutput out;
  for (int i = 0; i < 80 * 240; ++i) {
    const double t = i * kPeriod_s;
    if (i == 70 * 240) {
      robot.truth.terms.push_back(actuator::MakeTerm("payload", model.constants));
      robot.truth.terms.back().linear[0].value = 0.5;
    }
    out = monitor.Step(t, robot.At(t));
    reported_learning |= out.state == State::kLearning;
    if (out.alarm && reported_s == 0.0) reported_s = t;
    ASSERT_TRUE(t > 70.0 || !out.alarm) << t;
  }
  EXPECT_TRUE(reported_learning);
  EXPECT_GT(reported_s, 70.0);
  EXPECT_LT(reported_s, 72.0);
  EXPECT_EQ(out.state, State::kAlarm);
  EXPECT_NEAR(out.since_s, 70.0, 0.3);
  EXPECT_EQ(out.follows, Cause::kPayload);
  EXPECT_NEAR(out.change, 0.5, 0.02);
  EXPECT_GT(out.follows_share, 0.95);
  EXPECT_GT(out.rms_Nm, 1.0) << "of 0.5 kg at 0.3 m";
  EXPECT_LT(out.explained, 0.7);
}

TEST(Monitor, AtRestItSaysThatNothingCanBeSeen) {
  const actuator::JointModel model = SomeModel();
  Robot robot(model);
  Monitor monitor(model, {}, kPeriod_s);
  MonitorOutput out;
  for (int i = 0; i < 50 * 240; ++i) out = monitor.Step(i * kPeriod_s, robot.At(i * kPeriod_s));
  ASSERT_EQ(out.state, State::kWatching);
  robot.w = 0.0;
  robot.truth.terms[3].linear[0].value = 5.0;
  for (int i = 50 * 240; i < 60 * 240; ++i) {
    out = monitor.Step(i * kPeriod_s, robot.At(i * kPeriod_s));
  }
  EXPECT_EQ(out.state, State::kNotExcited);
  EXPECT_FALSE(out.alarm);
}

TEST(Monitor, LostSamplesAreSaidAndLeaveNoTrace) {
  const actuator::JointModel model = SomeModel();
  Robot robot(model);
  Monitor monitor(model, {}, kPeriod_s);
  std::mt19937_64 random(5);
  MonitorOutput out;
  for (int i = 0; i < 100 * 240; ++i) {
    JointReading reading = robot.At(i * kPeriod_s);
    const bool lost = random() % 200 == 0;
    reading.valid = !lost;
    if (lost) reading.position_rad = NAN;
    out = monitor.Step(i * kPeriod_s, reading);
    EXPECT_TRUE(!lost || out.state == State::kLost);
    ASSERT_FALSE(out.alarm) << i;
    ASSERT_TRUE(std::isfinite(out.rms_Nm + out.statistic + out.residual_Nm));
  }
  EXPECT_LT(out.rms_Nm, 0.02);
  EXPECT_GT(out.explained, 0.99);
}

TEST(Monitor, ALinearAxisReportsAMass) {
  actuator::JointModel model = SomeModel(types::JointKind::kPrismatic);
  model.terms.erase(model.terms.begin() + 1);
  model.terms.push_back(actuator::MakeTerm("rotor_inertia", model.constants));
  model.terms.back().linear[0].value = 0.13;
  model.terms.back().linear[0].fixed = true;
  Robot robot(model);
  Monitor monitor(model, {}, kPeriod_s);
  MonitorOutput out;
  for (int i = 0; i < 60 * 240; ++i) {
    if (i == 50 * 240) {
      robot.truth.terms.push_back(actuator::MakeTerm("inertia", model.constants));
      robot.truth.terms.back().linear[0].value = 0.1;
    }
    out = monitor.Step(i * kPeriod_s, robot.At(i * kPeriod_s));
  }
  EXPECT_TRUE(out.alarm);
  EXPECT_EQ(out.follows, Cause::kPayload);
  EXPECT_NEAR(out.change, 0.1, 0.01);
}

TEST(Monitor, TakesNoMemoryOnceItHasLearnt) {
  const actuator::JointModel model = SomeModel();
  Robot robot(model);
  Monitor monitor(model, {}, kPeriod_s);
  for (int i = 0; i < 50 * 240; ++i) monitor.Step(i * kPeriod_s, robot.At(i * kPeriod_s));
  const long before = test::Allocations();
  for (int i = 50 * 240; i < 60 * 240; ++i) {
    const JointReading reading = robot.At(i * kPeriod_s);
    monitor.Step(i * kPeriod_s, reading);
  }
  EXPECT_EQ(test::Allocations(), before);
}

TEST(Monitor, RefusesModelsAndFiguresThatCannotBe) {
  actuator::JointModel model = SomeModel();
  EXPECT_THROW(Monitor(model, {}, 0.0), std::invalid_argument);
  EXPECT_THROW(Monitor(model, {.block_s = -1.0}, kPeriod_s), std::invalid_argument);
  EXPECT_THROW(Monitor(model, {.learn_s = 1.0}, kPeriod_s), std::invalid_argument);
  EXPECT_THROW(Monitor(model, {.watch_s = 0.1}, kPeriod_s), std::invalid_argument);
  EXPECT_THROW(Monitor(model, {.false_alarm_h = NAN}, kPeriod_s), std::invalid_argument);
  for (int i = 0; i < 30; ++i) {
    model.terms.push_back(actuator::MakeTerm("quadratic_viscous", model.constants));
  }
  EXPECT_THROW(Monitor(model, {}, kPeriod_s), std::invalid_argument);
  model.terms.erase(model.terms.begin(), model.terms.begin() + 1);
  EXPECT_THROW(Monitor(model, {}, kPeriod_s), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::residual
