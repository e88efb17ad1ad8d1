// The biped through two virtual CAN buses as it is deployed, in real time: what feet and IMU report
// against the truth of the world behind the axes, a payload put on from outside, and an IMU that
// falls silent. Domains 188 to 191.
#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/sensors.h>
#include <sinew_idl/simulation.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "components/topics/node/node.h"
#include "tests/support/edited_config.h"
#include "tests/support/program.h"
#include "tests/support/realtime.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recorded_messages.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kCanBiped = SINEW_SOURCE_DIR "/robots/biped/";
constexpr double kWeight_N = 17.1 * 9.81;
constexpr std::uint64_t kSquats = 840;  // the first tick of it, 3.5 s: let go a second ago

// The deployment on buses of this folder: they are found there by name.
std::vector<std::string> Launch(const TemporaryFolder& folder, int domain,
                                const std::vector<std::string>& more,
                                const std::string& deployment = "deploy_biped_can.yaml") {
  std::vector<std::string> arguments = {
      "/usr/bin/env",
      "XDG_RUNTIME_DIR=" + folder.path().string(),
      kSinew,
      "launch",
      kCanBiped + deployment,
      "--domain",
      std::to_string(domain),
      "--set",
      std::string("realtime_priority=") + (MayBecomeRealtime() ? "true" : "false")};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Message>
std::map<std::uint64_t, Message> ByTick(const std::vector<Message>& messages) {
  std::map<std::uint64_t, Message> by_tick;
  for (const Message& message : messages) by_tick[message.header.tick] = message;
  return by_tick;
}

// The drives' position loops, and computed torque.
struct Mode {
  const char* name;
  const char* deployment;
  int domain;
  msg::CommandMode mode;
};

class BipedCanSquat : public ::testing::TestWithParam<Mode> {};

// Armed for 0.5 s, to the start for 3 s, and 1.8 s into the squat whose bottom comes after 2.5 s.
// Bounds are of medians: on a machine that does other work the logger, which has no priority,
// misses ticks.
TEST_P(BipedCanSquat, ReportsWhatTheWorldBehindTheAxesHas) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string();
  const Finished run =
      testing::Run(Launch(folder, GetParam().domain, {"--duration", "5.3", "--record", file},
                          GetParam().deployment),
                   60s);
  ASSERT_EQ(run.exit_code, 0) << run.output << run.error;
  const auto recording = PayloadsByTopic(file);
  const auto states = MessagesOf<msg::JointState>(recording, "joint_state");
  ASSERT_FALSE(states.empty());
  EXPECT_EQ(states.back().joint_count, 12);
  EXPECT_EQ(states.back().robot_state, msg::RobotState::kArmed) << run.output << run.error;
  const auto commands = MessagesOf<msg::JointCommand>(recording, "joint_command");
  ASSERT_FALSE(commands.empty());
  EXPECT_EQ(commands.back().mode[0], GetParam().mode);
  const auto truth = ByTick(MessagesOf<msg::SimBodyTruth>(recording, "sim_body_truth"));
  ASSERT_GT(truth.size(), states.size() / 2) << "one for each joint_state that was received";
  const double sunk_m = truth.begin()->second.position_m[2] - truth.rbegin()->second.position_m[2];

  std::vector<double> foot_N, weight_N, turned_rad, force_m_s2;
  for (const auto& feet : MessagesOf<msg::FootForce>(recording, "foot_force")) {
    const auto of_tick = truth.find(feet.header.tick);
    if (feet.header.tick < kSquats || of_tick == truth.end() || !feet.valid[0] || !feet.valid[4])
      continue;
    EXPECT_EQ(feet.header.session_id, of_tick->second.header.session_id);
    for (std::size_t i = 0; i < 8; ++i) {
      foot_N.push_back(std::abs(feet.force_N[i] - of_tick->second.contact_force_N[3 * i + 2]));
    }
    weight_N.push_back(std::accumulate(feet.force_N.begin(), feet.force_N.end(), 0.0));
  }
  for (const auto& imu : MessagesOf<msg::Imu>(recording, "imu")) {
    const auto of_tick = truth.find(imu.header.tick);
    if (imu.header.tick < kSquats || of_tick == truth.end() || !imu.valid) continue;
    const auto& q = of_tick->second.orientation_wxyz;
    const auto& measured = imu.orientation_wxyz;
    const double dot = std::inner_product(q.begin(), q.end(), measured.begin(), 0.0);
    turned_rad.push_back(2.0 * std::acos(std::min(1.0, std::abs(dot))));
    const auto& a = imu.acceleration_m_s2;
    force_m_s2.push_back(std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));
  }
  std::printf(
      "%zu of 1272 ticks; base sunk by %.3f m; medians: a foot sensor off by %.2f N, weight %.1f "
      "N, orientation off by %.5f rad, specific force %.3f m/s2\n",
      states.size(), sunk_m, Median(foot_N), Median(weight_N), Median(turned_rad),
      Median(force_m_s2));
  EXPECT_GT(weight_N.size(), 100U) << "of 432 ticks of the squat";
  EXPECT_GT(force_m_s2.size(), 100U);
  EXPECT_GT(sunk_m, 0.15);
  EXPECT_LT(Median(foot_N), 1.0);
  EXPECT_NEAR(Median(weight_N), kWeight_N, 0.02 * kWeight_N);
  EXPECT_LT(Median(turned_rad), 0.005);
  EXPECT_NEAR(Median(force_m_s2), 9.81, 0.2);
  EXPECT_NE((run.output + run.error).find(" dropped, 0 error frames"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Deployments, BipedCanSquat,
                         ::testing::Values(Mode{"Position", "deploy_biped_can.yaml", 188,
                                                msg::CommandMode::kPosition},
                                           Mode{"Torque", "deploy_biped_can_torque.yaml", 191,
                                                msg::CommandMode::kTorque}),
                         [](const auto& tested) { return std::string(tested.param.name); });

// The node of the IMU sends nothing any more, 6 s after the start of the axes: the robot is armed
// about a second after that start, and squats. Without motors it collapses.
TEST(BipedCanSystem, AnImuThatFallsSilentIsReportedAndTheMotorsAreOff) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string();
  const std::string axes =
      folder.Write("virtual_axes.yaml",
                   Edited(config::ReadFile(kCanBiped + "virtual_axes.yaml"),
                          {{"world: world.yaml", "world: " + kCanBiped + "world.yaml"},
                           {"sensor: imu, ", "sensor: imu, fault: {kind: lost, after_s: 6}, "}}));
  const Finished run = testing::Run(
      Launch(folder, 189,
             {"--duration", "7", "--record", file, "--set", "virtual_axes.config=" + axes}),
      60s);
  ASSERT_EQ(run.exit_code, 0) << run.output << run.error;
  const std::string text = run.output + run.error;
  EXPECT_NE(text.find("fall detector: upright"), std::string::npos) << text;
  EXPECT_NE(text.find("fault: fall: not known, lost: imu"), std::string::npos) << text;
  const auto recording = PayloadsByTopic(file);
  EXPECT_EQ(MessagesOf<msg::JointState>(recording, "joint_state").back().robot_state,
            msg::RobotState::kFault);
  EXPECT_FALSE(MessagesOf<msg::Imu>(recording, "imu").back().valid);
  const auto feet = MessagesOf<msg::FootForce>(recording, "foot_force");
  EXPECT_TRUE(feet.back().valid[0] && feet.back().valid[4]) << "the others go on";
  const auto truth = MessagesOf<msg::SimBodyTruth>(recording, "sim_body_truth");
  EXPECT_LT(truth.back().position_m[2], 0.6 * truth.front().position_m[2]);
}

// A payload that comes by topic, as sinew-body-disturbance sends it; and is gone 0.1 s after its
// last message.
TEST(BipedCanSystem, APayloadIsPutOnThroughTheAxesAndTheFeetWeighIt) {
  constexpr double kPayload_kg = 4.0;
  constexpr std::uint64_t kStands = 4 * 240;  // let go after 2.5 s, and half a second of start
  const TemporaryFolder folder;
  Program robot(Launch(folder, 190, {"--duration", "0", "--without", "reference"}));
  node::Options options;
  options.component = options.name = "test";
  options.domain_id = 190;
  node::Node node(options);
  auto states = node.MakeReader(node::kJointState);
  auto feet = node.MakeReader(node::kFootForce);
  auto loads = node.MakeWriter(node::kSimBodyDisturbance);
  double weight_N = 0.0;  // low-pass of half a second: it rocks on its toes
  const auto until = [&](double payload_kg, const std::function<bool(std::uint64_t)>& done) {
    const auto give_up = std::chrono::steady_clock::now() + 30s;
    while (std::chrono::steady_clock::now() < give_up) {
      const auto state = states.WaitNext(200ms);
      if (!state) continue;
      if (const auto forces = feet.TakeLatest()) {
        const auto& f = forces->force_N;
        weight_N += (std::accumulate(f.begin(), f.end(), 0.0) - weight_N) / 120.0;
      }
      if (payload_kg > 0.0) {
        msg::SimBodyDisturbance load;
        load.header = state->header;
        load.payload_link = "pelvis";
        load.payload_kg = payload_kg;
        (void)loads.Write(load);
      }
      if (done(state->header.tick)) return true;
    }
    return false;
  };
  const double with_payload_N = kWeight_N + 9.81 * kPayload_kg;
  ASSERT_TRUE(until(0.0, [](std::uint64_t tick) { return tick > kStands; }))
      << robot.output() << robot.error();
  EXPECT_NEAR(weight_N, kWeight_N, 0.02 * kWeight_N) << robot.output() << robot.error();
  EXPECT_TRUE(
      until(kPayload_kg,
            [&](std::uint64_t) { return std::abs(weight_N - with_payload_N) < 0.02 * kWeight_N; }))
      << weight_N << robot.output() << robot.error();
  EXPECT_TRUE(
      until(0.0, [&](std::uint64_t) { return std::abs(weight_N - kWeight_N) < 0.02 * kWeight_N; }))
      << weight_N << robot.output() << robot.error();
  robot.Signal(SIGINT);
  EXPECT_EQ(robot.Wait(30s), 0) << robot.output() << robot.error();
}

}  // namespace
}  // namespace sinew::testing
