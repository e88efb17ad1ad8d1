// sinew-performance as an object: its topic from joint_state, reference and actuator_state.
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/performance.h>
#include <sinew_idl/reference.h>

#include <cmath>
#include <memory>
#include <string>

#include "components/robot/performance/participant/component.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/node.h"

namespace sinew::performance {
namespace {

constexpr double kTopicPeriod_s = 1.0 / 240.0;
constexpr std::uint8_t kTopicJoints = 12;
constexpr double kError_rad = 0.02;

class PerformanceTopic : public ::testing::Test {
 protected:
  node::Options Named(const std::string& name) {
    node::Options options;
    options.component = options.name = name;
    options.config_path = SINEW_SOURCE_DIR "/robots/biped/performance.yaml";
    options.composition = &composition_;
    return options;
  }
  // A tick with every joint behind its reference by kError_rad, at 1 rad/s under 2 N m and 1 A.
  msg::JointState State(std::uint64_t session_id = 7) {
    msg::JointState state;
    state.header.session_id = session_id;
    state.header.tick = ++tick_;
    state.period_s = kTopicPeriod_s;
    state.joint_count = kTopicJoints;
    state.valid.fill(true);
    state.position_rad.fill(0.3);
    state.velocity_rad_s.fill(1.0);
    state.torque_Nm.fill(2.0);
    return state;
  }
  msg::Reference ReferenceOf(const msg::JointState& state) {
    msg::Reference reference;
    reference.header = state.header;
    reference.joint_count = kTopicJoints;
    reference.position_rad.fill(0.3 + kError_rad);
    return reference;
  }
  msg::PerformanceState Step(const msg::JointState& state, const msg::Reference* reference) {
    msg::ActuatorState actuator;
    actuator.header = state.header;
    actuator.joint_count = kTopicJoints;
    actuator.valid.fill(true);
    actuator.motor_current_A.fill(1.0);
    EXPECT_EQ(actuators_.Write(actuator), node::WriteStatus::kOk);
    if (reference != nullptr) {
      EXPECT_EQ(references_.Write(*reference), node::WriteStatus::kOk);
    }
    EXPECT_EQ(states_.Write(state), node::WriteStatus::kOk);
    EXPECT_TRUE(performance_->Ready());
    EXPECT_TRUE(performance_->Step());
    const auto message = outputs_.TakeLatest();
    EXPECT_TRUE(message.has_value());
    return message.value_or(msg::PerformanceState());
  }
  msg::PerformanceState Follow(int ticks) {
    msg::PerformanceState last;
    for (int i = 0; i < ticks; ++i) {
      const msg::JointState state = State();
      const msg::Reference reference = ReferenceOf(state);
      last = Step(state, &reference);
    }
    return last;
  }

  node::Composition composition_{node::Composition::Reach::kApart};
  node::StopFlag stop_;
  std::uint64_t tick_ = 0;
  node::Node outside_{Named("outside")};
  node::Writer<msg::JointState> states_ = outside_.MakeWriter(node::kJointState);
  node::Writer<msg::Reference> references_ = outside_.MakeWriter(node::kReference);
  node::Writer<msg::ActuatorState> actuators_ = outside_.MakeWriter(node::kActuatorState);
  node::Reader<msg::PerformanceState> outputs_ = outside_.MakeReader(node::kPerformance);
  std::unique_ptr<node::Component> performance_ = MakePerformance(Named("performance"), stop_);
};

TEST_F(PerformanceTopic, HasErrorsAndEnergiesOfEveryJoint) {
  const msg::PerformanceState m = Follow(241);  // 240 periods: 1 s
  EXPECT_EQ(m.joint_count, kTopicJoints);
  EXPECT_EQ(m.state_tick, tick_);
  EXPECT_EQ(m.since_tick, 1u);
  EXPECT_FALSE(m.stale);
  for (std::size_t j = 0; j < kTopicJoints; ++j) {
    EXPECT_TRUE(m.error_known[j]);
    EXPECT_NEAR(m.error_rad[j], kError_rad, 1e-12);
    EXPECT_NEAR(m.sliding_rms_rad[j], kError_rad, 1e-12);
    EXPECT_NEAR(m.window_share[j], 241.0 / 361.0, 1e-12);  // 1.5 s and both ends
    EXPECT_NEAR(m.mean_square_error_rad2[j], kError_rad * kError_rad, 1e-12);
    EXPECT_EQ(m.error_samples[j], 241u);
    EXPECT_NEAR(m.positive_work_J[j], 2.0, 1e-9);
  }
  EXPECT_NEAR(m.robot_net_work_J, 24.0, 1e-9);
  // R I^2 + Kt I N w for 1 s.
  const double kt3510 = 60.0 / (2.0 * M_PI * 600.0), kt5008 = 60.0 / (2.0 * M_PI * 400.0);
  EXPECT_NEAR(m.electrical_J[3], 0.18 + 100.0 * kt3510, 1e-4);
  EXPECT_NEAR(m.electrical_J[2], 0.122 + 80.0 * kt5008, 1e-4);
  EXPECT_TRUE(m.electrical_known);
  EXPECT_NEAR(
      m.robot_electrical_J,
      4.0 * (0.122 + 80.0 * kt5008) + 4.0 * (0.18 + 100.0 * kt3510) + 4.0 * (0.18 + 50.0 * kt3510),
      1e-3);
  EXPECT_TRUE(m.lifting_known);
  EXPECT_EQ(m.lifting_work_J, 0.0);  // it does not move
}

TEST_F(PerformanceTopic, WithoutAReferenceThereIsNoErrorAndTheEnergiesGoOn) {
  msg::PerformanceState m = Step(State(), nullptr);
  EXPECT_TRUE(m.stale);
  EXPECT_EQ(m.error_samples[0], 0u);
  const msg::JointState waiting = State();
  msg::Reference idle = ReferenceOf(waiting);
  idle.idle = true;
  m = Step(waiting, &idle);
  EXPECT_FALSE(m.stale);
  EXPECT_FALSE(m.error_known[0]);
  EXPECT_EQ(m.error_samples[0], 0u);
  EXPECT_NEAR(m.robot_net_work_J, 24.0 * kTopicPeriod_s, 1e-12);
  EXPECT_EQ(Follow(1).error_samples[0], 1u);
}

TEST_F(PerformanceTopic, AJointThatIsLostHasNoSample) {
  Follow(10);
  msg::JointState state = State();
  state.valid[4] = false;
  const msg::Reference reference = ReferenceOf(state);
  const msg::PerformanceState m = Step(state, &reference);
  EXPECT_FALSE(m.error_known[4]);
  EXPECT_EQ(m.error_samples[4], 10u);
  EXPECT_EQ(m.error_samples[5], 11u);
}

TEST_F(PerformanceTopic, ANewSessionBeginsAnew) {
  Follow(10);
  const msg::JointState state = State(8);
  const msg::Reference reference = ReferenceOf(state);
  const msg::PerformanceState m = Step(state, &reference);
  EXPECT_EQ(m.since_tick, 11u);
  EXPECT_EQ(m.error_samples[0], 1u);
  EXPECT_EQ(m.robot_net_work_J, 0.0);
}

TEST_F(PerformanceTopic, ARobotThatTheModelDoesNotFitDoesNotEndTheParticipant) {
  msg::JointState state = State();
  state.joint_count = 1;
  EXPECT_EQ(Step(state, nullptr).error_samples[0], 0u);
  state = State();
  state.period_s = 1e-300;  // no window has so many samples
  EXPECT_EQ(Step(state, nullptr).error_samples[0], 0u);
  state = State();
  state.position_rad.fill(1e300);
  state.torque_Nm.fill(std::nan(""));
  msg::Reference reference = ReferenceOf(state);
  EXPECT_TRUE(std::isfinite(Step(state, &reference).robot_net_work_J));
  EXPECT_EQ(Follow(3).error_samples[0], 3u);
}

}  // namespace
}  // namespace sinew::performance
