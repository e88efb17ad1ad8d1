// The rig in lockstep with sinew-residual: a payload is put on, the topic says so. Domains 137,
// 138.
#include <gtest/gtest.h>
#include <sinew_idl/residual.h>

#include <cstring>
#include <vector>

#include "components/topics/node/codec.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recording_payloads.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kWatched = SINEW_SOURCE_DIR "/robots/rig/deploy_residual.yaml";
constexpr double kTicksPerSecond = 240.0;

std::vector<msg::ResidualState> WatchRig(int domain, int seed, int seconds,
                                         const std::vector<std::string>& more = {}) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string();
  std::vector<std::string> arguments{kSinew,
                                     "launch",
                                     kWatched,
                                     "--set",
                                     "mode=lockstep",
                                     "--duration",
                                     std::to_string(seconds),
                                     "--seed",
                                     std::to_string(seed),
                                     "--domain",
                                     std::to_string(domain),
                                     "--record",
                                     file};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = Run(arguments, 240s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  std::vector<msg::ResidualState> messages;
  const auto payloads = PayloadsByTopic(file);
  for (const std::string& payload : payloads.at("residual")) {
    node::Bytes bytes(payload.size());
    std::memcpy(bytes.data(), payload.data(), payload.size());
    messages.emplace_back();
    EXPECT_TRUE(node::Decode(bytes, &messages.back()));
  }
  EXPECT_EQ(messages.size(), static_cast<std::size_t>(seconds * kTicksPerSecond));
  return messages;
}

class APayload : public ::testing::TestWithParam<int> {};

TEST_P(APayload, IsReportedWithinFiveSecondsOfSimulatedTime) {
  const int seed = GetParam();
  const double put_on_s = 40.0 + 0.37 * (seed % 14);
  const std::vector<msg::ResidualState> messages = WatchRig(
      137, seed, 51, {"--arg", "surrogate=--effect=payload=0.5@" + std::to_string(put_on_s)});
  double reported_s = 0.0;
  bool learnt = false;
  for (const msg::ResidualState& message : messages) {
    const double t = static_cast<double>(message.header.tick) / kTicksPerSecond;
    if (message.state[0] == msg::ResidualMonitorState::kWatching) learnt = true;
    if (message.alarm[0] && reported_s == 0.0) reported_s = t;
  }
  ASSERT_FALSE(messages.empty());
  EXPECT_TRUE(learnt);
  EXPECT_GT(reported_s, put_on_s) << "seed " << seed;
  EXPECT_LT(reported_s, put_on_s + 5.0) << "seed " << seed;
  const msg::ResidualState& last = messages.back();
  EXPECT_EQ(last.state[0], msg::ResidualMonitorState::kAlarm);
  EXPECT_EQ(last.follows[0], msg::ResidualCause::kPayload) << "seed " << seed;
  EXPECT_GT(last.follows_share[0], 0.5) << "seed " << seed;
  EXPECT_LE(last.follows_share[0], 1.0) << "seed " << seed;
  EXPECT_NEAR(last.change[0], 0.5, 0.05) << "seed " << seed;
  EXPECT_NEAR(1e-9 * static_cast<double>(last.since_ns[0] - messages[0].header.stamp_ns), put_on_s,
              0.5)
      << "seed " << seed;
  std::printf("seed %d: reported after %.2f s\n", seed, reported_s - put_on_s);
}

INSTANTIATE_TEST_SUITE_P(ResidualOverTopics, APayload, ::testing::Range(1, 7));

TEST(ResidualOverTopics, WithoutAChangeThereIsNoAlarmAndStandstillIsSaid) {
  // The benchmark's reference ends after 13 s: then nothing can be seen.
  const std::vector<msg::ResidualState> messages = WatchRig(
      138, 5, 20,
      {"--set", "reference.config=" SINEW_SOURCE_DIR "/robots/rig/reference_benchmark.yaml"});
  ASSERT_FALSE(messages.empty());
  for (const msg::ResidualState& message : messages) ASSERT_FALSE(message.alarm[0]);
  EXPECT_EQ(messages[10 * 240].state[0], msg::ResidualMonitorState::kLearning);
  EXPECT_GT(messages[10 * 240].learnt_share[0], 0.1);
  EXPECT_EQ(messages.back().state[0], msg::ResidualMonitorState::kNotExcited);
  EXPECT_LT(messages.back().learnt_share[0], 1.0);
  EXPECT_GT(messages.back().explained_share[0], 0.9);
}

}  // namespace
}  // namespace sinew::testing
