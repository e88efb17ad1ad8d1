// A joint_state and an actuator_state of a robot that the model does not fit: sinew-residual
// reports it and goes on, as the next messages may be the robot's own.
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/residual.h>

#include <memory>
#include <string>

#include "components/robot/residual/participant/component.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/node.h"

namespace sinew::residual {
namespace {

constexpr std::uint32_t kAllSignals = 0x7FFF;

class UnfitRobot : public ::testing::Test {
 protected:
  node::Options Named(const std::string& name) {
    node::Options options;
    options.component = options.name = name;
    options.config_path = SINEW_SOURCE_DIR "/robots/rig/residual.yaml";
    options.composition = &composition_;
    return options;
  }
  void Step(std::uint8_t joints, std::uint32_t measured_flags, double period_s = 1.0 / 240.0) {
    msg::JointState state;
    state.header.session_id = 7;
    state.header.tick = ++tick_;
    state.period_s = period_s;
    state.joint_count = joints;
    state.valid.fill(true);
    msg::ActuatorState actuator;
    actuator.header = state.header;
    actuator.joint_count = joints;
    actuator.valid.fill(true);
    actuator.measured_flags = measured_flags;
    ASSERT_EQ(actuators_.Write(actuator), node::WriteStatus::kOk);
    ASSERT_EQ(states_.Write(state), node::WriteStatus::kOk);
    ASSERT_TRUE(residual_->Ready());
    ASSERT_TRUE(residual_->Step());
  }
  msg::ResidualMonitorState StateOfTheFirstJoint() {
    const auto message = outputs_.TakeLatest();
    EXPECT_TRUE(message.has_value());
    return message ? message->state[0] : msg::ResidualMonitorState::kAlarm;
  }

  node::Composition composition_{node::Composition::Reach::kApart};
  node::StopFlag stop_;
  std::uint64_t tick_ = 0;
  node::Node outside_{Named("outside")};
  node::Writer<msg::JointState> states_ = outside_.MakeWriter(node::kJointState);
  node::Writer<msg::ActuatorState> actuators_ = outside_.MakeWriter(node::kActuatorState);
  node::Reader<msg::ResidualState> outputs_ = outside_.MakeReader(node::kResidual);
  std::unique_ptr<node::Component> residual_ = MakeResidual(Named("residual"), stop_);
};

TEST_F(UnfitRobot, DoesNotEndTheParticipant) {
  Step(0, kAllSignals);
  EXPECT_EQ(StateOfTheFirstJoint(), msg::ResidualMonitorState::kLost);
  Step(1, 0);
  EXPECT_EQ(StateOfTheFirstJoint(), msg::ResidualMonitorState::kLost);
  Step(1, kAllSignals, 1e-300);  // no window has so many samples
  EXPECT_EQ(StateOfTheFirstJoint(), msg::ResidualMonitorState::kLost);
  for (int n = 0; n < 50; ++n) Step(1, kAllSignals);
  EXPECT_EQ(StateOfTheFirstJoint(),
            msg::ResidualMonitorState::kNotExcited);  // at rest, and monitored
}

}  // namespace
}  // namespace sinew::residual
