// What pneumatics takes from stiffness_request and operator_command on a live robot. Domain 48.
#include <gtest/gtest.h>

#include <chrono>

#include "components/robot/pneumatics/participant/requests.h"

namespace sinew::pneumatics {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kSession = 9;

class RequestsOnLiveHardware : public testing::Test {
 protected:
  static node::Options OptionsOf(const char* name) {
    node::Options options;
    options.component = options.name = name;
    options.domain_id = 48;
    options.mode = node::TimeMode::kRealtime;
    return options;
  }
  static PneumaticsConfig TwoJoints() {
    PneumaticsConfig config;
    config.joints.resize(2);
    return config;
  }
  template <class Message>
  static Message From(std::uint64_t session_id, msg::Origin origin) {
    Message message;
    message.header.session_id = session_id;
    message.header.origin = origin;
    return message;
  }
  void AskPressure(std::uint64_t session_id, msg::Origin origin, double pressure_bar) {
    auto request = From<msg::StiffnessRequest>(session_id, origin);
    request.joint_count = 1;
    request.kind[0] = msg::StiffnessKind::kPressure;
    request.pressure_bar[0] = pressure_bar;
    EXPECT_EQ(stiffness_.Write(request), node::WriteStatus::kOk);
  }
  void Say(std::uint64_t session_id, msg::Origin origin, msg::OperatorAction action) {
    auto command = From<msg::OperatorCommand>(session_id, origin);
    command.action = action;
    EXPECT_EQ(operator_.Write(command), node::WriteStatus::kOk);
  }
  template <class Condition>
  bool TakeUntil(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (std::chrono::steady_clock::now() < end) {
      requests_.Take({.session_id = kSession}, types::Origin::kLive, &managers_);
      if (condition()) return true;
      node_.WaitForData(5ms);
    }
    return false;
  }
  bool Matched() {
    return TakeUntil(
        [&] { return stiffness_.matched_readers() == 1 && operator_.matched_readers() == 1; });
  }

  node::Node sender_{OptionsOf("sender")}, node_{OptionsOf("pneumatics")};
  node::Writer<msg::StiffnessRequest> stiffness_ = sender_.MakeWriter(node::kStiffnessRequest);
  node::Writer<msg::OperatorCommand> operator_ = sender_.MakeWriter(node::kOperatorCommand);
  node::StopFlag stop_;
  node::TickLoop loop_{node_, stop_};
  PressureRequests requests_{node_, loop_, TwoJoints()};
  std::vector<PressureManager> managers_ = {PressureManager({}), PressureManager({})};
};

TEST_F(RequestsOnLiveHardware, StiffnessIsTakenFromTheLiveSessionOnly) {
  ASSERT_TRUE(Matched());
  AskPressure(kSession, msg::Origin::kLive, 0.5);
  AskPressure(kSession, msg::Origin::kReplay, 1.0);
  AskPressure(kSession, msg::Origin::kSim, 1.5);
  AskPressure(kSession + 1, msg::Origin::kLive, 2.0);
  ASSERT_TRUE(TakeUntil([&] { return requests_.refused() == 3; }));
  EXPECT_EQ(managers_[0].target_bar(), 0.5);
}

TEST_F(RequestsOnLiveHardware, AnEstopCountsAlwaysAResetFromTheLiveSessionOnly) {
  ASSERT_TRUE(Matched());
  Say(kSession + 1, msg::Origin::kReplay, msg::OperatorAction::kEstop);
  Say(kSession, msg::Origin::kReplay, msg::OperatorAction::kReset);
  Say(kSession + 1, msg::Origin::kLive, msg::OperatorAction::kReset);
  ASSERT_TRUE(TakeUntil([&] { return requests_.refused() == 2; }));
  EXPECT_FALSE(requests_.MayHold(types::RobotState::kArmed));
  Say(kSession, msg::Origin::kLive, msg::OperatorAction::kReset);
  EXPECT_TRUE(TakeUntil([&] { return requests_.MayHold(types::RobotState::kArmed); }));
}

}  // namespace
}  // namespace sinew::pneumatics
