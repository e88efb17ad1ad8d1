// A recorded reference on a live robot, from no permission to the disarm that ends it: the state
// provider with a plant that says it is hardware, control and the operator's commands as processes.
// Domain 53.
#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>
#include <vector>

#include "components/robot/provider/participant/run_provider.h"
#include "components/topics/node/node.h"
#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;

constexpr int kPermitDomain = 53;
constexpr double kReplayTakeover_s = 1.0;
constexpr double kRate_Hz = 100.0;

node::Options PermitNode(const char* name) {
  node::Options options;
  options.component = options.name = name;
  options.domain_id = kPermitDomain;
  options.mode = node::TimeMode::kRealtime;
  return options;
}

// A joint that is where it was commanded to be a cycle ago; it says that it is hardware.
class LiveJoint final : public provider::Plant {
 public:
  int joint_count() const override { return 1; }
  bool live() const override { return true; }
  std::uint32_t measured_flags() const override { return 0; }
  void Reset(provider::PlantSensors* sensors) override { sensors->valid[0] = true; }
  void Step(const provider::PlantCommand& command, double, provider::PlantSensors* s) override {
    s->valid[0] = true;
    if (command.mode[0] != types::ControlMode::kPosition) return;
    s->position_rad[0] = command.position_rad[0];
    const std::lock_guard<std::mutex> lock(mutex_);
    commanded_rad_.push_back(command.position_rad[0]);
  }
  // Every position that the guard has let through, in order.
  std::vector<double> commanded_rad() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return commanded_rad_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<double> commanded_rad_;
};

// Writes a replayed reference in every tick, as sinew-player does.
class Player {
 public:
  Player() : thread_([this] { Play(); }) {}
  ~Player() {
    stop_ = true;
    thread_.join();
  }
  void MoveTo(double position_rad) { position_rad_ = position_rad; }

 private:
  void Play() {
    node::Node node(PermitNode("player"));
    auto states = node.MakeReader(node::kJointState);
    auto references = node.MakeWriter(node::kReference);
    while (!stop_) {
      const auto state = states.WaitNext(20ms);
      if (!state) continue;
      msg::Reference reference;
      reference.header = state->header;
      reference.header.origin = msg::Origin::kReplay;
      reference.state_tick = state->header.tick;
      reference.joint_count = 1;
      reference.position_rad[0] = position_rad_;
      (void)references.Write(reference);
    }
  }

  std::atomic<double> position_rad_{1.0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// `sinew WORDS` in this domain.
Finished Command(std::vector<std::string> words, const char* timeout_s = "20") {
  words.insert(words.begin(), kSinew);
  words.insert(words.end(), {"--domain", std::to_string(kPermitDomain), "--timeout", timeout_s});
  return launch::Run(words, 40s);
}

class LiveRobot : public ::testing::Test {
 protected:
  LiveRobot()
      : control_({std::string(SINEW_BIN_DIR) + "/sinew-control", "--domain",
                  std::to_string(kPermitDomain), "--config",
                  folder_.Write("control.yaml",
                                "schema: sinew-control/1\njoints: [{strategy: position, drive: "
                                "{gear_ratio: 1}, replay_takeover_s: 1}]\n")}),
        observer_(PermitNode("observer")),
        states_(observer_.MakeReader(node::kJointState)),
        commands_(observer_.MakeReader(node::kJointCommand)),
        provider_([this] {
          // A guard that bears the pauses of a busy machine.
          provider::GuardConfig guard;
          guard.missed_periods = 50;
          guard.fault_after = 3000ms;
          provider::RunProvider(PermitNode("provider"), stop_, {.rate_Hz = kRate_Hz}, guard,
                                joint_);
        }) {}
  ~LiveRobot() override {
    stop_.Request();
    provider_.join();
  }

  // Lets the robot run this many cycles; false when it does not.
  bool Cycles(std::uint64_t count) {
    const auto first = states_.WaitNext(20s);
    if (!first) return false;
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (std::chrono::steady_clock::now() < end) {
      const auto state = states_.WaitNext(1s);
      if (!state) continue;
      robot_ = state->robot_state;
      position_rad_ = state->position_rad[0];
      if (state->header.tick >= first->header.tick + count) return true;
    }
    return false;
  }
  template <class Condition>
  bool CyclesUntil(Condition condition) {
    for (int i = 0; i < 40; ++i) {
      if (condition()) return true;
      if (!Cycles(25)) return false;
    }
    return condition();
  }

  TemporaryFolder folder_;
  LiveJoint joint_;
  node::StopFlag stop_;
  Program control_;
  node::Node observer_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::JointCommand> commands_;
  msg::RobotState robot_ = msg::RobotState::kFault;
  double position_rad_ = 0.0;
  std::thread provider_;
};

TEST_F(LiveRobot, ARecordingMovesItOnlyWithPermissionAndWithoutAStep) {
  Player player;
  ASSERT_TRUE(Cycles(10) && commands_.WaitNext(20s)) << "nobody answers";
  const Finished early = Command({"permit-replay", "player"}, "1");
  EXPECT_EQ(early.exit_code, 1) << "it is not armed";
  ASSERT_EQ(Command({"arm"}).exit_code, 0) << control_.error();

  // Without permission it is held where it is.
  ASSERT_TRUE(CyclesUntil([&] { return joint_.commanded_rad().size() > 100; })) << control_.error();
  for (const double commanded_rad : joint_.commanded_rad()) ASSERT_EQ(commanded_rad, 0.0);
  EXPECT_EQ(robot_, msg::RobotState::kArmed) << "and control goes on holding it";
  EXPECT_TRUE(control_.WaitForText("sinew permit-replay player", 10s)) << control_.error();

  const Finished other = Command({"permit-replay", "somebody"}, "3");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.error.find("'player'"), std::string::npos) << other.error;
  const Finished permit = Command({"permit-replay", "player"});
  ASSERT_EQ(permit.exit_code, 0) << permit.error;
  EXPECT_TRUE(control_.WaitForText("the recording that 'player' plays may move this robot", 1s))
      << "the command said so before control did: " << control_.error();
  ASSERT_TRUE(CyclesUntil([&] { return std::abs(position_rad_ - 1.0) < 1e-6; }))
      << control_.error();
  // The quintic is 15/8 of its mean velocity at the most, and begins as 10 u^3; a command may come
  // kLate cycles after the last one on a busy machine. A step would be 1 rad.
  constexpr double kLate = 10.0 / (kReplayTakeover_s * kRate_Hz);
  const std::vector<double> way_rad = joint_.commanded_rad();
  double largest_rad = 0.0;
  for (std::size_t i = 1; i < way_rad.size(); ++i) {
    largest_rad = std::max(largest_rad, std::abs(way_rad[i] - way_rad[i - 1]));
  }
  EXPECT_LE(largest_rad, 15.0 / 8.0 * kLate);
  const auto first =
      std::find_if(way_rad.begin(), way_rad.end(), [](double q) { return q != 0.0; });
  ASSERT_NE(first, way_rad.end());
  EXPECT_LE(*first, 10.0 * std::pow(kLate, 3));
  RecordProperty("largest_step_rad", std::to_string(largest_rad));
  RecordProperty("first_step_rad", std::to_string(*first));

  // Disarm ends it: armed again, the recording is refused.
  ASSERT_EQ(Command({"disarm"}).exit_code, 0);
  player.MoveTo(0.5);
  ASSERT_EQ(Command({"arm"}).exit_code, 0);
  const std::size_t before = joint_.commanded_rad().size();
  ASSERT_TRUE(CyclesUntil([&] { return joint_.commanded_rad().size() > before + 100; }))
      << control_.error();
  const std::vector<double> held_rad = joint_.commanded_rad();
  for (std::size_t i = before; i < held_rad.size(); ++i) ASSERT_NEAR(held_rad[i], 1.0, 1e-6);
  EXPECT_EQ(robot_, msg::RobotState::kArmed);
}

TEST_F(LiveRobot, AnotherReferenceEndsThePermission) {
  ASSERT_TRUE(Cycles(10) && commands_.WaitNext(20s)) << "nobody answers";
  ASSERT_EQ(Command({"arm"}).exit_code, 0) << control_.error();
  {
    Player player;
    ASSERT_EQ(Command({"permit-replay", "player"}).exit_code, 0) << control_.error();
    ASSERT_TRUE(CyclesUntil([&] { return std::abs(position_rad_ - 1.0) < 1e-6; }));
  }
  // A player that is started again is another writer, of the same name.
  Player second;
  second.MoveTo(0.5);
  ASSERT_TRUE(control_.WaitForText("permit-replay of 'player' has ended", 20s)) << control_.error();
  ASSERT_TRUE(Cycles(100));
  EXPECT_NEAR(position_rad_, 1.0, 1e-6);
  EXPECT_EQ(robot_, msg::RobotState::kArmed);
}

// A robot that is armed, and whose provider alone reads what operators say.
TEST(PermitReplay, IsNotDoneUntilAComponentSaysThatItPermits) {
  Player player;
  node::Node provider(PermitNode("provider"));
  auto states = provider.MakeWriter(node::kJointState);
  auto commands = provider.MakeReader(node::kOperatorCommand);
  std::atomic<bool> stop{false};
  std::thread armed([&] {
    msg::JointState state;
    state.header.origin = msg::Origin::kLive;
    state.header.session_id = 1;
    state.joint_count = 1;
    state.robot_state = msg::RobotState::kArmed;
    while (!stop) {
      ++state.header.tick;
      (void)states.Write(state);
      provider.WaitForData(10ms);
    }
  });
  const Finished permit = Command({"permit-replay", "player"}, "5");
  stop = true;
  armed.join();
  EXPECT_EQ(permit.exit_code, 1) << "said to be done, and nobody permits it";
  EXPECT_NE(permit.error.find("no component says that it permits"), std::string::npos)
      << permit.error;
  EXPECT_TRUE(commands.TakeLatest()) << "it was never said";
}

}  // namespace
}  // namespace sinew::testing
