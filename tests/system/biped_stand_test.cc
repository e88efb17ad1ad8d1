// The biped on its stand in lockstep: world, reference and control for twelve joints, over topics.
// Domains 180 to 182.
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/performance.h>
#include <sinew_idl/reference.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"
#include "tests/system/recorded_messages.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kBipedFolder = SINEW_SOURCE_DIR "/robots/biped/";
constexpr std::size_t kBipedJoints = 12;
constexpr std::size_t kSquatTicks = 15 * 240;
constexpr std::size_t kLeftKnee = 3, kRightKnee = 9;
// deploy_stand.yaml and reference_benchmark.yaml: held for 0.5 s, soft start of 3 s, two squats of
// 5 s.
constexpr std::size_t kHeldTicks = 120, kFirstTop = kHeldTicks + 720;
constexpr std::size_t kFirstBottom = kFirstTop + 600;
constexpr double kTopKnee_rad = 0.547359903, kBottomKnee_rad = 2.627020958;
constexpr double kSink_rad = 2e-3;  // at rest, until the drives' loops carry the legs; 0.8e-3 found

struct StandRun {
  std::vector<msg::JointState> states;
  std::vector<msg::Reference> references;
  std::vector<msg::JointCommand> commands;
  std::vector<msg::PerformanceState> performance;
  nlohmann::json offline;  // `sinew performance` of the recording: its one session
};

StandRun Squat(int domain, const std::string& control, const std::vector<std::string>& more = {}) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "run.mcap").string();
  std::vector<std::string> arguments{kSinew,
                                     "launch",
                                     kBipedFolder + "deploy_stand.yaml",
                                     "--set",
                                     "control.config=" + kBipedFolder + control,
                                     "--domain",
                                     std::to_string(domain),
                                     "--record",
                                     file};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished run = Run(arguments, 240s);
  EXPECT_EQ(run.exit_code, 0) << run.output << run.error;
  const auto recording = PayloadsByTopic(file);
  const Finished offline = Run(
      {kSinew, "performance", file, "--config", kBipedFolder + "performance_stand.yaml", "--json"});
  EXPECT_EQ(offline.exit_code, 0) << offline.error;
  return {MessagesOf<msg::JointState>(recording, "joint_state"),
          MessagesOf<msg::Reference>(recording, "reference"),
          MessagesOf<msg::JointCommand>(recording, "joint_command"),
          MessagesOf<msg::PerformanceState>(recording, "performance"),
          nlohmann::json::parse(offline.output).at(0)};
}

// Mean over the joints, from the first squat on, rad2.
double MeanSquareError_rad2(const StandRun& run) {
  double sum = 0.0;
  for (std::size_t t = kFirstTop; t < run.states.size(); ++t) {
    for (std::size_t j = 0; j < kBipedJoints; ++j) {
      sum += std::pow(run.references[t].position_rad[j] - run.states[t].position_rad[j], 2);
    }
  }
  return sum / static_cast<double>(kBipedJoints * (run.states.size() - kFirstTop));
}

void ExpectTwelveJointsInEveryTick(const StandRun& run) {
  ASSERT_EQ(run.states.size(), kSquatTicks);
  ASSERT_EQ(run.references.size(), kSquatTicks);
  ASSERT_EQ(run.commands.size(), kSquatTicks);
  for (std::size_t t = 0; t < kSquatTicks; ++t) {
    ASSERT_EQ(run.states[t].joint_count, kBipedJoints);
    ASSERT_EQ(run.references[t].joint_count, kBipedJoints);
    ASSERT_EQ(run.references[t].header.tick, run.states[t].header.tick);
    ASSERT_FALSE(run.references[t].stale);
    ASSERT_FALSE(run.references[t].idle) << t;
    ASSERT_EQ(run.commands[t].joint_count, kBipedJoints);
    ASSERT_EQ(run.commands[t].reference_tick, run.states[t].header.tick);
    ASSERT_FALSE(run.commands[t].stale) << t;
  }
}

// The topic is what the recording gives afterwards, and its MSE that of the messages themselves.
void ExpectPerformance(const StandRun& run) {
  ASSERT_EQ(run.performance.size(), kSquatTicks);
  const msg::PerformanceState& last = run.performance.back();
  double sum_rad2 = 0.0;
  for (std::size_t t = 0; t < kSquatTicks; ++t) {
    sum_rad2 += std::pow(
        run.references[t].position_rad[kLeftKnee] - run.states[t].position_rad[kLeftKnee], 2);
  }
  const double expected_rad2 = sum_rad2 / static_cast<double>(kSquatTicks);
  EXPECT_NEAR(last.mean_square_error_rad2[kLeftKnee], expected_rad2, 1e-12 * expected_rad2);
  const nlohmann::json& robot = run.offline.at("robot");
  EXPECT_EQ(robot.at("mean_square_error_rad2"), last.robot_mean_square_error_rad2);
  EXPECT_EQ(robot.at("positive_work_J"), last.robot_positive_work_J);
  EXPECT_EQ(robot.at("net_work_J"), last.robot_net_work_J);
  EXPECT_EQ(robot.at("electrical_J"), last.robot_electrical_J);
  EXPECT_EQ(robot.at("lifting_work_J"), last.lifting_work_J);
  EXPECT_EQ(run.offline.at("joints").at(kLeftKnee).at("sliding_rms_rad"),
            last.sliding_rms_rad[kLeftKnee]);
  EXPECT_GT(last.lifting_work_J, 1.0);  // the legs alone
  std::printf(
      "MSE %.3g rad2; |work| %.1f, work+ %.1f, net %.1f, electrical %.1f, at least %.1f J\n",
      last.robot_mean_square_error_rad2, last.robot_absolute_work_J, last.robot_positive_work_J,
      last.robot_net_work_J, last.robot_electrical_J, last.lifting_work_J);
}

TEST(BipedStand, SquatsWithTheReferenceOfTwelveJoints) {
  const StandRun run = Squat(180, "control_position.yaml");
  ExpectTwelveJointsInEveryTick(run);
  if (HasFatalFailure()) return;
  // The joints stand where the squats begin: the soft start moves nothing.
  for (std::size_t t = 0; t <= kFirstTop; ++t) {
    for (const std::size_t knee : {kLeftKnee, kRightKnee}) {
      ASSERT_NEAR(run.references[t].position_rad[knee], kTopKnee_rad, kSink_rad) << t;
    }
  }
  // Down and up again, both legs alike, at rest at the bottom.
  for (const std::size_t bottom : {kFirstBottom, kFirstBottom + 1200}) {
    const msg::Reference& reference = run.references[bottom];
    EXPECT_NEAR(reference.position_rad[kLeftKnee], kBottomKnee_rad, 1e-6);
    EXPECT_NEAR(reference.velocity_rad_s[kLeftKnee], 0.0, 1e-6);
    for (std::size_t j = 0; j < kBipedJoints; ++j) {
      EXPECT_EQ(reference.position_rad[j], reference.position_rad[(j + 6) % kBipedJoints]);
    }
  }
  EXPECT_NEAR(run.references.back().position_rad[kLeftKnee], kTopKnee_rad, 1e-6);
  for (std::size_t j = 0; j < kBipedJoints; ++j) {
    EXPECT_NEAR(run.states.back().position_rad[j], run.references.back().position_rad[j], 0.01);
  }
  EXPECT_LT(MeanSquareError_rad2(run), 1e-4);
  ExpectPerformance(run);
}

TEST(BipedStand, FollowsWithThePublishedGains) {
  const StandRun run = Squat(181, "control_pid.yaml");
  ExpectTwelveJointsInEveryTick(run);
  if (HasFatalFailure()) return;
  for (const msg::JointCommand& command : run.commands) {
    for (std::size_t j = 0; j < kBipedJoints; ++j) {
      ASSERT_EQ(command.mode[j], msg::CommandMode::kTorque);
    }
  }
  EXPECT_LT(MeanSquareError_rad2(run), 0.02);
  ExpectPerformance(run);
  // Torques are held over a cycle, so that their samples are their means: friction takes net work,
  // and the legs are lifted.
  EXPECT_GT(run.performance.back().robot_net_work_J, 0.0);
  EXPECT_GT(run.performance.back().robot_positive_work_J, run.performance.back().lifting_work_J);
}

TEST(BipedStand, MovesWithSeaPeaActuatorsInKneesAndAnkles) {
  const StandRun run =
      Squat(182, "control_position.yaml",
            {"--arg", "world=--model", "--arg", "world=" + kBipedFolder + "model_sea_pea.yaml"});
  ExpectTwelveJointsInEveryTick(run);
  if (HasFatalFailure()) return;
  // Motor and link differ by at most half of the play; the drives' loops are on the motor.
  EXPECT_NEAR(run.states[kFirstBottom].position_rad[kLeftKnee], kBottomKnee_rad, 0.06);
  EXPECT_LT(MeanSquareError_rad2(run), 1e-3);
}

}  // namespace
}  // namespace sinew::testing
