// Start and stop of the operator, on a live robot and in a simulation. Domain 49.
#include <gtest/gtest.h>

#include <chrono>

#include "components/robot/reference/participant/translate.h"

namespace sinew::reference {
namespace {

using namespace std::chrono_literals;

node::Options StartOptions(const char* name) {
  node::Options options;
  options.component = options.name = name;
  options.domain_id = 49;
  options.mode = node::TimeMode::kRealtime;
  return options;
}

struct Heard {
  bool start = false;
  std::uint64_t refused = 0;
};

// Of one start command, in session 9 of a state provider with this origin.
Heard HeardOf(std::uint64_t session_id, msg::Origin origin, types::Origin running) {
  node::Node sender(StartOptions("sender")), node(StartOptions("reference"));
  auto writer = sender.MakeWriter(node::kOperatorCommand);
  node::StopFlag stop;
  node::TickLoop loop(node, stop);
  OperatorStarts starts(node);
  msg::OperatorCommand command;
  command.header.session_id = session_id;
  command.header.origin = origin;
  command.action = msg::OperatorAction::kStart;
  bool sent = false;
  Heard heard;
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!heard.start && heard.refused == 0 && std::chrono::steady_clock::now() < end) {
    if (!sent && writer.matched_readers() == 1) {
      sent = writer.Write(command) == node::WriteStatus::kOk;
    }
    RobotReferenceInput input;
    input.session_id = 9;
    starts.AddTo(&input, running, &loop);
    heard = {input.operator_start, starts.refused()};
    node.WaitForData(5ms);
  }
  return heard;
}

TEST(OperatorStarts, OfTheLiveSessionStartTheReference) {
  EXPECT_TRUE(HeardOf(9, msg::Origin::kLive, types::Origin::kLive).start);
  EXPECT_TRUE(HeardOf(9, msg::Origin::kReplay, types::Origin::kSim).start) << "a simulation";
}

TEST(OperatorStarts, OfAnotherSessionOrARecordingAreRefusedOnALiveRobot) {
  EXPECT_EQ(HeardOf(9, msg::Origin::kReplay, types::Origin::kLive).refused, 1u);
  EXPECT_EQ(HeardOf(9, msg::Origin::kSim, types::Origin::kLive).refused, 1u);
  EXPECT_EQ(HeardOf(8, msg::Origin::kLive, types::Origin::kLive).refused, 1u);
  EXPECT_EQ(HeardOf(8, msg::Origin::kSim, types::Origin::kSim).refused, 1u);
}

}  // namespace
}  // namespace sinew::reference
