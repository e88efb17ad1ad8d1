// The program sinew-surrogate over DDS. Domains 60 to 62.
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>

#include <chrono>
#include <string>
#include <vector>

#include "components/topics/node/node.h"
#include "tests/support/program.h"

namespace sinew::testing {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

const std::string kProgram = std::string(SINEW_BIN_DIR) + "/sinew-surrogate";

struct Seen {
  std::vector<msg::JointState> joints;
  std::vector<msg::ActuatorState> actuators;
};

// Lockstep, one second, answering every tick with a torque; everything that was published.
Seen RunLockstep(int domain, const std::vector<std::string>& extra) {
  node::Options options;
  options.component = options.name = "surrogate_test";
  options.domain_id = domain;
  options.mode = node::TimeMode::kLockstep;
  node::Node node(options);
  auto joint_state = node.MakeReader(node::kJointState);
  auto actuator_state = node.MakeReader(node::kActuatorState);
  auto joint_command = node.MakeWriter(node::kJointCommand);
  std::vector<std::string> arguments{kProgram,     "--domain", std::to_string(domain),
                                     "--lockstep", "--arm",    "--duration",
                                     "1",          "--await",  "joint_command"};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  Program program(arguments);
  Seen seen;
  const auto give_up = std::chrono::steady_clock::now() + seconds(40);
  while (std::chrono::steady_clock::now() < give_up) {
    const auto state = joint_state.WaitNext(milliseconds(200));
    if (!state) {
      if (!IsRunning(program.pid())) break;
      continue;
    }
    seen.joints.push_back(*state);
    while (auto actuator = actuator_state.TakeNext()) seen.actuators.push_back(*actuator);
    msg::JointCommand command;
    command.header = state->header;
    command.joint_count = 1;
    command.mode[0] = msg::CommandMode::kTorque;
    command.motor_torque_Nm[0] = 0.02;
    EXPECT_EQ(joint_command.Write(command), node::WriteStatus::kOk);
    if (state->last_tick) break;
  }
  EXPECT_EQ(program.Wait(seconds(20)), 0) << program.error();
  while (auto actuator = actuator_state.TakeNext()) seen.actuators.push_back(*actuator);
  return seen;
}

TEST(SurrogateParticipant, PublishesEveryTickOfALockstepSessionAndMovesWhenCommanded) {
  const Seen seen = RunLockstep(60, {});
  ASSERT_EQ(seen.joints.size(), 240u);
  ASSERT_EQ(seen.actuators.size(), 240u);
  for (std::size_t i = 0; i < seen.joints.size(); ++i) {
    ASSERT_EQ(seen.joints[i].header.tick, i);
    ASSERT_EQ(seen.joints[i].header.origin, msg::Origin::kSim);
    ASSERT_EQ(seen.joints[i].joint_count, 1);
    ASSERT_TRUE(seen.joints[i].valid[0]);
  }
  EXPECT_EQ(seen.joints.back().robot_state, msg::RobotState::kArmed);
  // 0.02 N·m at the motor is 1.54 N·m at the output, against 1.22 of breakaway and with 4 bar
  // behind it.
  EXPECT_GT(seen.joints.back().position_rad[0], 0.2);
  EXPECT_GT(seen.actuators.back().motor_current_A[0], 1.0);
  EXPECT_NEAR(seen.actuators.front().chamber_pressure_bar[0], 4.0, 0.05);
}

TEST(SurrogateParticipant, OneSeedGivesIdenticalPayloadsAndEffectsChangeThem) {
  const Seen first = RunLockstep(61, {"--seed", "9"});
  const Seen second = RunLockstep(61, {"--seed", "9"});
  ASSERT_EQ(first.joints.size(), second.joints.size());
  for (std::size_t i = 0; i < first.joints.size(); ++i) {
    ASSERT_TRUE(first.joints[i] == second.joints[i]) << i;
    ASSERT_TRUE(first.actuators[i] == second.actuators[i]) << i;
  }
  const Seen with_effect = RunLockstep(61, {"--seed", "9", "--effect", "payload=1"});
  EXPECT_LT(with_effect.joints.back().position_rad[0], first.joints.back().position_rad[0] - 0.05);
}

TEST(SurrogateParticipant, ListsItsEffects) {
  const Finished finished = testing::Run({kProgram, "--list-effects"});
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_NE(finished.output.find("seal_hysteresis"), std::string::npos);
}

TEST(SurrogateParticipant, BadInputEndsWithTwoAndOneLine) {
  const Finished finished = testing::Run({kProgram, "--domain", "62", "--effect", "wobble"});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.error.find("wobble"), std::string::npos);
}

}  // namespace
}  // namespace sinew::testing
