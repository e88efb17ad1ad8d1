// Two payloads of one type compared.
#include "tools/rerun/message_diff.h"

#include <gtest/gtest.h>
#include <sinew_idl/joint.h>

#include <cmath>
#include <cstring>
#include <string>

#include "components/topics/node/codec.h"
#include "tools/rerun/output_facts.h"
#include "tools/rerun/stage.h"

namespace sinew::rerun {
namespace {

node::Bytes Encoded(const msg::JointCommand& command) {
  node::Bytes bytes;
  EXPECT_TRUE(node::Encode(command, &bytes));
  return bytes;
}

msg::JointCommand SomeCommand() {
  msg::JointCommand command;
  command.header.tick = 7;
  command.joint_count = 1;
  command.motor_torque_Nm[0] = 0.1;
  command.reference_tick = 7;
  command.actuator_tick = 6;
  command.event_ids = {11, 12};
  return command;
}

TEST(MessageDiff, EqualPayloadsHaveNoDifference) {
  const node::Bytes payload = Encoded(SomeCommand());
  EXPECT_FALSE(FirstDifference(TypeOf("joint_command"), payload, payload).has_value());
}

TEST(MessageDiff, TheFirstDifferingFieldIsNamedWithBothValuesAndTheByte) {
  msg::JointCommand other = SomeCommand();
  other.motor_torque_Nm[0] = std::nextafter(0.1, 1.0);
  other.position_rad[3] = 1.0;
  const node::Bytes then = Encoded(SomeCommand()), now = Encoded(other);
  const auto difference = FirstDifference(TypeOf("joint_command"), then, now);
  ASSERT_TRUE(difference.has_value());
  EXPECT_EQ(difference->field, "motor_torque_Nm[0]");
  EXPECT_EQ(difference->recorded, "0.1");
  EXPECT_EQ(difference->rerun, "0.10000000000000002");
  ASSERT_LT(difference->byte, then.size());
  EXPECT_NE(then[difference->byte], now[difference->byte]);
}

TEST(MessageDiff, ALongerSequenceDiffersByItsCount) {
  msg::JointCommand other = SomeCommand();
  other.event_ids = {11};
  const auto difference =
      FirstDifference(TypeOf("joint_command"), Encoded(SomeCommand()), Encoded(other));
  ASSERT_TRUE(difference.has_value());
  EXPECT_EQ(difference->field, "event_ids.count");
  EXPECT_EQ(difference->recorded, "2");
  EXPECT_EQ(difference->rerun, "1");
}

TEST(MessageDiff, APayloadThatIsNoSuchMessageDiffersByItsByte) {
  const node::Bytes then = Encoded(SomeCommand());
  node::Bytes now = then;
  now.resize(20);
  const auto difference = FirstDifference(TypeOf("joint_command"), then, now);
  ASSERT_TRUE(difference.has_value());
  EXPECT_EQ(difference->field, "(payload)");
  EXPECT_EQ(difference->byte, 20u);
  EXPECT_EQ(difference->rerun, "nothing: it has 20 bytes");
}

TEST(MessageDiff, AnOutputNamesItsInputsAndEvents) {
  const OutputFacts facts("joint_command");
  UsedInputs used;
  facts.AddTo(Encoded(SomeCommand()), &used);
  EXPECT_TRUE(used.any_output);
  EXPECT_EQ(used.tick.at("reference"), 7u);
  EXPECT_EQ(used.tick.at("actuator_state"), 6u);
  EXPECT_EQ(used.events, (std::set<std::uint64_t>{11, 12}));
  UsedInputs of_nothing;
  facts.AddTo({}, &of_nothing);
  EXPECT_TRUE(of_nothing.tick.empty());
}

TEST(MessageDiff, AnEventHasTheIdOfItsCanonicalPayload) {
  node::Bytes payload = Encoded(SomeCommand());
  recording::CanonicalizeCdr(TypeOf("joint_command"), &payload);
  EXPECT_EQ(node::EventId(SomeCommand()), node::EventId(std::span<const std::byte>(payload)));
  msg::JointCommand other = SomeCommand();
  other.stale = true;
  EXPECT_NE(node::EventId(SomeCommand()), node::EventId(other));
}

}  // namespace
}  // namespace sinew::rerun
