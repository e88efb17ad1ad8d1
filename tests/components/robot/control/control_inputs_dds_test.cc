// What control takes from motion_request and operator_command on a live robot. Domain 50.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "components/robot/control/participant/translate.h"

namespace sinew::control {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kLiveSession = 9;

node::Options InputOptions(const char* name) {
  node::Options options;
  options.component = options.name = name;
  options.domain_id = 50;
  options.mode = node::TimeMode::kRealtime;
  return options;
}

class InputsOnLiveHardware : public testing::Test {
 protected:
  static ControlConfig Config() {
    ControlConfig config;
    config.motion_requests = MotionRequests::kOptional;
    config.joints.resize(1);
    config.joints[0].strategy = Strategy::kPosition;
    config.joints[0].motor_torque_limit_Nm = 1.0;
    return config;
  }
  ~InputsOnLiveHardware() override {
    done_ = true;
    writer_.join();
  }
  // An armed robot's states, every 5 ms.
  void WriteStates() {
    node::Node provider(InputOptions("provider"));
    auto states = provider.MakeWriter(node::kJointState);
    while (!done_) {
      msg::JointState state;
      state.header.session_id = kLiveSession;
      state.header.tick = ++tick_;
      state.header.origin = msg::Origin::kLive;
      state.period_s = 0.004;
      state.robot_state = msg::RobotState::kArmed;
      state.joint_count = 1;
      state.valid[0] = true;
      EXPECT_EQ(states.Write(state), node::WriteStatus::kOk);
      provider.WaitForData(5ms);
    }
  }
  // Cycles until the condition holds of what control gathers.
  template <class Condition>
  bool CyclesUntil(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < end) {
      if (const auto tick = loop_.Next()) last_ = inputs_.Gather(*tick);
      if (condition()) return true;
    }
    return false;
  }
  // Control itself and its loop, for permissions, read operator_command.
  bool Matched() {
    return CyclesUntil(
        [&] { return motion_.matched_readers() == 1 && operator_.matched_readers() == 2; });
  }
  void AskMotion(std::uint64_t session_id, msg::Origin origin) {
    msg::MotionRequest request;
    request.header.session_id = session_id;
    request.header.tick = tick_;
    request.header.origin = origin;
    request.joint_count = 1;
    request.kind[0] = msg::MotionKind::kHold;
    EXPECT_EQ(motion_.Write(request), node::WriteStatus::kOk);
  }
  void Say(std::uint64_t session_id, msg::Origin origin, msg::OperatorAction action) {
    msg::OperatorCommand command;
    command.header.session_id = session_id;
    command.header.origin = origin;
    command.action = action;
    EXPECT_EQ(operator_.Write(command), node::WriteStatus::kOk);
  }

  std::atomic<std::uint64_t> tick_{0};
  node::Node sender_{InputOptions("sender")}, node_{InputOptions("control")};
  node::Writer<msg::MotionRequest> motion_ = sender_.MakeWriter(node::kMotionRequest);
  node::Writer<msg::OperatorCommand> operator_ = sender_.MakeWriter(node::kOperatorCommand);
  node::StopFlag stop_;
  node::TickLoop loop_{node_, stop_};
  ControlInputs inputs_{node_, loop_, Config()};
  RobotInput last_;
  std::atomic<bool> done_{false};
  std::thread writer_{[this] { WriteStates(); }};
};

TEST_F(InputsOnLiveHardware, MotionIsTakenFromTheLiveSessionOnly) {
  ASSERT_TRUE(Matched());
  AskMotion(kLiveSession, msg::Origin::kReplay);
  AskMotion(kLiveSession, msg::Origin::kSim);
  AskMotion(kLiveSession + 1, msg::Origin::kLive);
  ASSERT_TRUE(CyclesUntil([&] { return inputs_.refused() == 3; }));
  EXPECT_EQ(last_.motion[0].kind, types::Motion::kNone);
  AskMotion(kLiveSession, msg::Origin::kLive);
  EXPECT_TRUE(CyclesUntil([&] { return last_.motion[0].kind == types::Motion::kHold; }));
}

TEST_F(InputsOnLiveHardware, AnEstopCountsAlwaysAResetFromTheLiveSessionOnly) {
  ASSERT_TRUE(Matched());
  EXPECT_TRUE(last_.armed);
  Say(kLiveSession + 1, msg::Origin::kReplay, msg::OperatorAction::kEstop);
  Say(kLiveSession, msg::Origin::kReplay, msg::OperatorAction::kReset);
  Say(kLiveSession + 1, msg::Origin::kLive, msg::OperatorAction::kReset);
  ASSERT_TRUE(CyclesUntil([&] { return inputs_.refused() == 2; }));
  EXPECT_FALSE(last_.armed);
  Say(kLiveSession, msg::Origin::kLive, msg::OperatorAction::kReset);
  EXPECT_TRUE(CyclesUntil([&] { return last_.armed; }));
}

}  // namespace
}  // namespace sinew::control
