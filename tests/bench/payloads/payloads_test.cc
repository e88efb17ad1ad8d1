// A hundredth of the soak of bench/payloads: mutated payloads of every topic into every
// participant. SINEW_PAYLOADS=10000000 makes a long run of it.
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "bench/payloads/seeds.h"
#include "bench/payloads/soak.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::payloads {
namespace {

constexpr std::uint64_t kPayloads = 1'000'000;  // of all groups

std::uint64_t PayloadsOf(double share) {
  const char* text = std::getenv("SINEW_PAYLOADS");
  const std::uint64_t all = text != nullptr ? std::strtoull(text, nullptr, 10) : kPayloads;
  return static_cast<std::uint64_t>(share * static_cast<double>(all));
}

std::vector<Group> Groups() {
  const std::filesystem::path root = SINEW_SOURCE_DIR;
  return AllGroups(root / "bench/payloads", root / "robots/rig");
}

class Payloads : public ::testing::Test {
 protected:
  // Every line is made, and nobody reads it.
  Payloads() {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("", std::make_shared<spdlog::sinks::null_sink_mt>()));
  }
  ~Payloads() override { spdlog::set_default_logger(before_); }

 private:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

void ExpectNoDefect(const Group& group, std::uint64_t payloads) {
  Soak soak(group, {});
  soak.Run(payloads);
  ASSERT_FALSE(soak.stopped()) << "by a signal";
  for (const Defect& defect : soak.defects()) {
    ADD_FAILURE() << group.name << ", " << defect.member << ": " << defect.what << ", "
                  << defect.times << " times, first in cycle " << defect.cycle;
  }
  for (const MemberCount& member : soak.members()) {
    if (member.name == "logger") continue;  // works as samples come
    EXPECT_GT(member.steps, soak.cycles() / 2) << member.name;
  }
  for (const TopicCount& topic : soak.topics()) {
    EXPECT_GT(topic.mutated, 0u) << topic.topic;
    if (topic.readers == 0 || group.name == "recording") continue;  // which keeps what is malformed
    EXPECT_GT(topic.malformed, 0u) << topic.topic;
  }
}

TEST_F(Payloads, OfEveryTopicEndNoParticipantWithNetworks) {
  ExpectNoDefect(Groups()[0], PayloadsOf(0.4));
}

TEST_F(Payloads, OfEveryTopicEndNoParticipantWithModels) {
  ExpectNoDefect(Groups()[1], PayloadsOf(0.4));
}

TEST_F(Payloads, OfEveryTopicDoNotStopARecording) { ExpectNoDefect(Groups()[2], PayloadsOf(0.2)); }

// A participant with two faults: it trusts the counts of a readout, and publishes its weights
// unchecked.
class Careless final : public node::Component {
 public:
  Careless(const node::Options& options, node::StopFlag& stop)
      : node_(options), loop_(node_, stop) {}
  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    const msg::Readout& readout = readout_.value();
    const std::size_t weights = std::size_t{readout.output_count} * readout.feature_count;
    msg::JointCommand command;
    if (weights > 0) command.velocity_rad_s[0] = readout.weight.at(weights - 1);
    loop_.Publish(output_, command, *tick);
    return true;
  }

 private:
  node::Node node_;
  node::TickLoop loop_;
  node::TickInput<msg::JointState>& state_ = loop_.AddInput(node::kJointState);
  node::TickInput<msg::Readout>& readout_ = loop_.AddInput(node::kReadout, {.required = false});
  node::Writer<msg::JointCommand> output_ = node_.MakeWriter(node::kJointCommand);
};

TEST_F(Payloads, FindAPlantedFault) {
  const Group group{
      .name = "planted",
      .members = {
          {.name = "careless", .make = [](const node::Options& options, Environment& environment) {
             return std::make_unique<Careless>(options, environment.stop);
           }}}};
  Soak soak(group, {.topic = "readout"});
  soak.Run(5'000);
  bool ended = false, not_finite = false;
  for (const Defect& defect : soak.defects()) {
    ended = ended || defect.what.find("range_check") != std::string::npos;
    not_finite = not_finite || defect.what.find("not finite") != std::string::npos;
  }
  EXPECT_TRUE(ended) << "an index beyond the sequence";
  EXPECT_TRUE(not_finite) << "a command that is not finite";
}

}  // namespace
}  // namespace sinew::payloads
