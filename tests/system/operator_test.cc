// The rig in real time: arming, a second state provider, a controller that is killed.
#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <optional>

#include "components/topics/node/node.h"
#include "tests/support/edited_config.h"
#include "tests/support/patient_guard.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

const std::string kBin = SINEW_BIN_DIR;
const std::string kRig = SINEW_SOURCE_DIR "/robots/rig/";

node::Options Observer(int domain) {
  node::Options options;
  options.component = options.name = "observer";
  options.domain_id = domain;
  return options;
}

// Waits for a joint_state that fulfils the condition.
template <class Condition>
bool WaitForState(node::Reader<msg::JointState>& reader, Condition condition,
                  std::chrono::seconds limit = 20s) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto state = reader.WaitNext(1000ms);
    if (state && condition(*state)) return true;
  }
  return false;
}

bool WaitForRobot(node::Reader<msg::JointState>& reader, msg::RobotState wanted) {
  return WaitForState(reader,
                      [&](const msg::JointState& state) { return state.robot_state == wanted; });
}

struct Rig {
  explicit Rig(int number)
      : domain(std::to_string(number)),
        surrogate(
            {kBin + "/sinew-surrogate", "--config", PatientSurrogate(folder), "--domain", domain}),
        reference({kBin + "/sinew-reference", "--config", kRig + "reference_benchmark.yaml",
                   "--domain", domain}),
        control(
            {kBin + "/sinew-control", "--config", kRig + "control_pid.yaml", "--domain", domain}),
        observer(Observer(number)),
        state(observer.MakeReader(node::kJointState)),
        statuses(observer.MakeReader(node::kComponentStatus)) {}

  int Command(const std::string& word) {
    return Run({kBin + "/sinew", word, "--domain", domain}).exit_code;
  }

  TemporaryFolder folder;
  std::string domain;
  Program surrogate, reference, control;
  node::Node observer;
  node::Reader<msg::JointState> state;
  node::Reader<msg::ComponentStatus> statuses;
};

TEST(Operator, ArmsMovesAndStopsTheRobot) {
  Rig rig(145);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kDisarmed)) << rig.surrogate.error();
  ASSERT_EQ(rig.Command("arm"), 0);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kArmed));
  // The benchmark moves 30 degrees to both sides.
  EXPECT_TRUE(WaitForState(
      rig.state, [](const msg::JointState& s) { return std::abs(s.position_rad[0]) > 0.4; }));
  ASSERT_EQ(rig.Command("estop"), 0);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kEstopped));
  EXPECT_NE(rig.Command("arm"), 0) << "an estop ends only by reset";
  ASSERT_EQ(rig.Command("reset"), 0);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kDisarmed));
}

TEST(Operator, AKilledControllerIsBridgedAndThenAFault) {
  Rig rig(146);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kDisarmed)) << rig.surrogate.error();
  ASSERT_EQ(rig.Command("arm"), 0);
  ASSERT_TRUE(WaitForState(rig.state, [](const msg::JointState& s) {
    return s.robot_state == msg::RobotState::kArmed && std::abs(s.velocity_rad_s[0]) > 0.05;
  }));
  rig.control.Signal(SIGKILL);
  bool damped = false;
  msg::Fault fault;
  ASSERT_TRUE(WaitForState(rig.state, [&](const msg::JointState& s) {
    damped = damped || s.robot_state == msg::RobotState::kDamped;
    fault = s.fault;
    return s.robot_state == msg::RobotState::kFault;
  }));
  EXPECT_TRUE(damped) << "the gap was not bridged";
  EXPECT_EQ(fault.cause, msg::FaultCause::kCommandMissing);
  EXPECT_EQ(fault.limit, 3000.0);
  EXPECT_GT(fault.value, fault.limit);
  // The same in the status and in the log, in words.
  std::optional<msg::ComponentStatus> status;
  const auto limit = std::chrono::steady_clock::now() + 10s;
  while (std::chrono::steady_clock::now() < limit) {
    status = rig.statuses.WaitNext(1000ms);
    if (status && status->name == "surrogate" && status->state == msg::ComponentState::kFault)
      break;
  }
  ASSERT_TRUE(status);
  EXPECT_EQ(status->fault, fault) << status->message;
  EXPECT_NE(status->message.find("joint_command missing for "), std::string::npos)
      << status->message;
  EXPECT_TRUE(rig.surrogate.WaitForText("fault: joint_command missing for ", 5s))
      << rig.surrogate.error();
  EXPECT_TRUE(rig.surrogate.WaitForText(" ms, limit 3000 ms: ", 1s)) << rig.surrogate.error();
  EXPECT_NE(rig.Command("arm"), 0) << "a fault ends only by reset";
}

TEST(Operator, AFloodOfCommandsDoesNotFillTheLog) {
  Program surrogate(
      {kBin + "/sinew-surrogate", "--config", kRig + "surrogate.yaml", "--domain", "114"});
  node::Node observer(Observer(114));
  auto states = observer.MakeReader(node::kJointState);
  auto commands = observer.MakeWriter(node::kOperatorCommand);
  ASSERT_TRUE(WaitForRobot(states, msg::RobotState::kDisarmed)) << surrogate.error();
  msg::OperatorCommand reset;  // of another session: refused
  reset.action = msg::OperatorAction::kReset;
  reset.reason = "flood";
  for (int i = 0; i < 500; ++i) (void)commands.Write(reset);
  msg::OperatorCommand estop;
  estop.action = msg::OperatorAction::kEstop;
  ASSERT_TRUE(WaitForState(states, [&](const msg::JointState& s) {
    (void)commands.Write(estop);
    return s.robot_state == msg::RobotState::kEstopped;
  }));
  ASSERT_TRUE(WaitForState(states, [&](const msg::JointState&) {
    (void)commands.Write(estop);
    return surrogate.WaitForText("before it not logged)", 0ms);
  })) << surrogate.error();
  const std::string log = surrogate.output() + surrogate.error();
  std::size_t lines = 0;
  for (std::size_t at = log.find("operator:"); at != std::string::npos;
       at = log.find("operator:", at + 1)) {
    ++lines;
  }
  EXPECT_LE(lines, 40U) << "ten a second";
}

TEST(Operator, ASecondStateProviderIsRefused) {
  Rig rig(147);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kDisarmed));
  const Finished second =
      testing::Run({kBin + "/sinew-surrogate", "--config", kRig + "surrogate.yaml", "--domain",
                    rig.domain, "--name", "second"});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.error.find("already has a state provider: 'surrogate'"), std::string::npos)
      << second.error;
}

TEST(Operator, ALaunchBesideARunningRobotStartsNothing) {
  Rig rig(147);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kDisarmed));
  const Finished second = testing::Run({kBin + "/sinew", "launch", kRig + "deploy_rig.yaml",
                                        "--mode", "realtime", "--domain", rig.domain});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.error.find("already has a state provider: 'surrogate'"), std::string::npos)
      << second.error;
  EXPECT_EQ(second.output, "") << "nothing was started";
}

TEST(Operator, AControllerOfAnotherRobotLetsNobodyArm) {
  Program surrogate(
      {kBin + "/sinew-surrogate", "--config", kRig + "surrogate.yaml", "--domain", "147"});
  Program control({kBin + "/sinew-control", "--config",
                   SINEW_SOURCE_DIR "/robots/biped/control_position.yaml", "--domain", "147"});
  ASSERT_TRUE(control.WaitForText("another number of joints", 10s)) << control.error();
  const Finished arm = testing::Run({kBin + "/sinew", "arm", "--domain", "147", "--timeout", "2"});
  EXPECT_EQ(arm.exit_code, 1);
  EXPECT_NE(arm.error.find("joint_command names 12 joints, expected 1"), std::string::npos)
      << arm.error;
}

// The refusal stands in the provider's status, which is latched: the next arm is not answered by
// it.
TEST(Operator, AControllerOfAJointWithAnotherNameLetsNobodyArm) {
  Program world({kBin + "/sinew-world", "--config", kRig + "world.yaml", "--domain", "147"});
  const struct {
    const char *joint, *says;
    int exit_code;
  } kCases[] = {{"elbow", "joint 0 is 'joint', and 'elbow'", 1},
                {"joint", "joint_command of 'joint'", 0}};
  for (const auto& [joint, says, exit_code] : kCases) {
    const TemporaryFolder folder;
    const std::string config = folder.Write(
        "control.yaml",
        EditedRigConfig("control_position.yaml",
                        {{"joints:", std::string("joint_names: [") + joint + "]\njoints:"}}));
    Program control(
        {kBin + "/sinew-control", "--name", joint, "--config", config, "--domain", "147"});
    ASSERT_TRUE(world.WaitForText(says, 20s)) << world.error();
    const Finished arm =
        testing::Run({kBin + "/sinew", "arm", "--domain", "147", "--timeout", "2"});
    EXPECT_EQ(arm.exit_code, exit_code) << arm.error << world.error();
    const char* why = "joint 0: another name in the controller's configuration";
    EXPECT_EQ(arm.error.find(why) != std::string::npos, exit_code != 0) << arm.error;
  }
}

// The first one cannot answer while the second one looks, as when datagrams are lost.
TEST(Operator, OfTwoStateProvidersTheYoungerEnds) {
  Rig rig(147);
  ASSERT_TRUE(WaitForRobot(rig.state, msg::RobotState::kDisarmed));
  const auto is_of = [](std::uint64_t session, bool wanted) {
    return [session, wanted](const msg::JointState& s) {
      return (s.header.session_id == session) == wanted;
    };
  };
  std::uint64_t session = 0;
  ASSERT_TRUE(WaitForState(rig.state, [&session](const msg::JointState& s) {
    session = s.header.session_id;
    return s.header.tick > 500;  // 2 s older than the second
  }));
  rig.surrogate.Signal(SIGSTOP);
  Program second({kBin + "/sinew-surrogate", "--config", kRig + "surrogate.yaml", "--domain",
                  rig.domain, "--name", "second"});
  ASSERT_TRUE(WaitForState(rig.state, is_of(session, false))) << second.error();
  rig.surrogate.Signal(SIGCONT);
  EXPECT_EQ(second.Wait(10s), 1);
  EXPECT_NE((second.output() + second.error()).find("this one ends"), std::string::npos)
      << second.error();
  EXPECT_EQ(rig.surrogate.Wait(0ms), Program::kTimeout) << rig.surrogate.error();
  EXPECT_TRUE(WaitForState(rig.state, is_of(session, true)));
}

}  // namespace
}  // namespace sinew::testing
