// A composition apart: participants without DDS, and payloads of any kind into their readers.
#include "components/topics/node/composition.h"

#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>

#include <string>
#include <vector>

#include "components/topics/node/tick_loop.h"

namespace sinew::node {
namespace {

class CompositionApart : public ::testing::Test {
 protected:
  Options Named(const std::string& name) {
    Options options;
    options.component = options.name = name;
    options.composition = &composition_;
    return options;
  }
  static Bytes StateOf(std::uint64_t tick) {
    msg::JointState state;
    state.header.session_id = 7;
    state.header.tick = tick;
    state.header.origin = msg::Origin::kSim;
    state.period_s = 1.0 / 240.0;
    Bytes bytes;
    EXPECT_TRUE(Encode(state, &bytes));
    return bytes;
  }
  void Send(const Bytes& bytes) { ASSERT_EQ(state_(bytes.data(), bytes.size()), WriteStatus::kOk); }

  Composition composition_{Composition::Reach::kApart};
  StopFlag stop_;
  Node outside_{Named("outside")};
  Node node_{Named("control")};
  RawWriter state_ = outside_.MakeRawWriter(*FindTopic(kJointState.name));
};

TEST_F(CompositionApart, AWellFormedTriggerIsACycle) {
  TickLoop loop(node_, stop_);
  auto& state = loop.AddInput(kJointState);
  EXPECT_FALSE(loop.Ready());
  Send(StateOf(3));
  ASSERT_TRUE(loop.Ready());
  const auto tick = loop.Next();
  ASSERT_TRUE(tick.has_value());
  EXPECT_EQ(tick->tick, 3u);
  EXPECT_EQ(state.value().header.session_id, 7u);
  EXPECT_FALSE(loop.Ready());
}

// Ready() was true of it once, and Next() then waited for the next good one: in a composition that
// is the thread of the state provider.
TEST_F(CompositionApart, AMalformedTriggerIsNoCycleAndNobodyWaits) {
  TickLoop loop(node_, stop_);
  (void)loop.AddInput(kJointState);
  Bytes cut = StateOf(3);
  cut.resize(cut.size() / 2);
  Send(cut);
  EXPECT_FALSE(loop.Ready());
  EXPECT_EQ(composition_.taken(kJointState.name).malformed, 1u);
  Send(StateOf(4));
  ASSERT_TRUE(loop.Ready());
  EXPECT_EQ(loop.Next()->tick, 4u);
}

TEST_F(CompositionApart, CarriesEventsAndPayloadsForRecorders) {
  auto reader = node_.MakeReader(kOperatorCommand);
  std::vector<Bytes> recorded;
  node_.ReadRaw(*FindTopic(kOperatorCommand.name),
                [&](RawSample&& sample) { recorded.push_back(std::move(sample.payload)); });
  auto writer = outside_.MakeWriter(kOperatorCommand);
  msg::OperatorCommand command;
  command.action = msg::OperatorAction::kArm;
  ASSERT_EQ(writer.Write(command), WriteStatus::kOk);
  const auto heard = reader.TakeNext();
  ASSERT_TRUE(heard.has_value());
  EXPECT_EQ(heard->action, msg::OperatorAction::kArm);
  EXPECT_EQ(recorded.size(), 1u);
  const auto name = node_.NameOf(reader.writer());
  ASSERT_TRUE(name.has_value());
  EXPECT_EQ(name->participant, "outside");
  EXPECT_FALSE(name->own);
}

}  // namespace
}  // namespace sinew::node
