// The programs reference, regime, pneumatics and control around the surrogate, as processes over
// DDS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/recording.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>

#include <chrono>
#include <memory>

#include "components/topics/node/tick_loop.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;
using testing::Program;
using testing::TemporaryFolder;

const std::string kBin = SINEW_BIN_DIR;
const std::string kRig = std::string(SINEW_SOURCE_DIR) + "/robots/rig";

struct Deployment {
  std::string domain;
  bool lockstep = true;
  std::string reference = kRig + "/reference_benchmark.yaml";
  std::string regime = kRig + "/regime.yaml";
  std::string pneumatics = kRig + "/pneumatics.yaml";
  std::string control = kRig + "/control_pid_model.yaml";
};

std::unique_ptr<Program> Start(const Deployment& deployment, const std::string& name,
                               const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {kBin + "/sinew-" + name, "--domain", deployment.domain};
  if (deployment.lockstep) arguments.push_back("--lockstep");
  arguments.insert(arguments.end(), more.begin(), more.end());
  return std::make_unique<Program>(arguments);
}

node::Options ObserverOptions(const Deployment& deployment) {
  node::Options options;
  options.component = options.name = "observer";
  options.domain_id = std::stoi(deployment.domain);
  options.mode = deployment.lockstep ? node::TimeMode::kLockstep : node::TimeMode::kRealtime;
  return options;
}

TEST(Participants, FindTheContactThenFollowTheBenchmark) {
  const TemporaryFolder folder;
  Deployment deployment{.domain = "70"};
  deployment.regime = kRig + "/regime_active.yaml";
  deployment.control = folder.Write(
      "control.yaml",
      "schema: sinew-control/1\nmotion_requests: every_tick\njoints:\n  - strategy: pid_linear\n"
      "    model: " +
          kRig +
          "/surrogate_model.yaml\n    velocity_from: motor\n"
          "    pid: {proportional_Nm_rad: 18.7, integral_Nm_rad_s: 5.75, derivative_Nm_s_rad: "
          "0.945, "
          "derivative_filter_Hz: 20}\n");
  deployment.pneumatics =
      folder.Write("pneumatics.yaml",
                   "schema: sinew-pneumatics/1\nhold_disarmed: true\nmotion_requests: true\n"
                   "joints: [{target_bar: 4, reservoir_sensor: true, valve_feedback: true}]\n");
  deployment.reference = folder.Write(
      "reference.yaml",
      "schema: sinew-reference/1\nstart_delay_s: 14\njoints:\n  - {kind: sine, amplitude_rad: "
      "0.5236, frequency_Hz: 0.4, duration_s: 10}\n");

  node::StopFlag stop;
  node::Node node(ObserverOptions(deployment));
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto& actuator = loop.AddInput(node::kActuatorState);
  auto& reference = loop.AddInput(node::kReference);
  auto& regime = loop.AddInput(node::kRegime);
  auto& air = loop.AddInput(node::kPneumaticState);
  auto& command = loop.AddInput(node::kJointCommand);
  // Flow control: the provider waits for the observer, too, so that it misses nothing.
  auto progress = node.MakeWriter(node::kRecordingProgress);

  const auto reference_program = Start(deployment, "reference", {"--config", deployment.reference});
  const auto regime_program = Start(deployment, "regime", {"--config", deployment.regime});
  const auto pneumatics_program =
      Start(deployment, "pneumatics", {"--config", deployment.pneumatics});
  const auto control_program = Start(deployment, "control", {"--config", deployment.control});
  // It waits for every awaited answer of tick 0, so it may start before the others are there.
  const auto provider =
      Start(deployment, "surrogate",
            {"--config", kRig + "/surrogate.yaml", "--arm", "--duration", "27", "--await",
             "joint_command", "--await", "valve_command", "--await", "recording_progress:64"});

  bool saw_setup = false;
  double setup_done_s = -1.0, squares = 0.0, worst_air_bar = 0.0;
  int scored = 0, unknown_after = 0, stale = 0;
  while (const auto tick = loop.Next()) {
    loop.Publish(progress, msg::RecordingProgress{}, *tick);
    const double time_s = static_cast<double>(tick->tick) * tick->period_s;
    saw_setup = saw_setup || regime.value().phase[0] == msg::RegimePhase::kSetup;
    if (setup_done_s < 0.0 && regime.value().phase[0] == msg::RegimePhase::kExecution) {
      setup_done_s = time_s;
      EXPECT_EQ(regime.value().regime[0], msg::RegimeKind::kPea);
      EXPECT_EQ(regime.value().contact[0], msg::ContactSide::kLower);
      // Motor and output zero are aligned in the surrogate: alpha counts from half the backlash
      // below.
      const double gap_rad =
          actuator.value().motor_position_rad[0] / 100.0 - state.value().position_rad[0];
      EXPECT_NEAR(regime.value().play_angle_rad[0], gap_rad + 0.5 * 0.0464258, 1e-3);
    }
    if (setup_done_s >= 0.0) unknown_after += regime.value().regime[0] == msg::RegimeKind::kUnknown;
    stale += command.value().stale;
    EXPECT_EQ(command.value().reference_tick, tick->tick);
    if (time_s > 16.0 && time_s < 26.0) {
      EXPECT_FALSE(reference.value().idle);
      const double error_rad = reference.value().position_rad[0] - state.value().position_rad[0];
      squares += error_rad * error_rad;
      ++scored;
      worst_air_bar = std::max(worst_air_bar, std::abs(air.value().pressure_bar[0] - 4.0));
    } else if (time_s < 14.0) {
      EXPECT_TRUE(reference.value().idle);
    }
  }
  EXPECT_TRUE(saw_setup);
  EXPECT_GT(setup_done_s, 0.1);
  EXPECT_LT(setup_done_s, 13.0);
  EXPECT_EQ(unknown_after, 0);
  EXPECT_EQ(stale, 0);
  ASSERT_GT(scored, 2000);
  EXPECT_LT(squares / scored, 1e-4);
  EXPECT_LT(worst_air_bar, 0.06);
  for (Program* program : {provider.get(), reference_program.get(), regime_program.get(),
                           pneumatics_program.get(), control_program.get()}) {
    EXPECT_EQ(program->Wait(seconds(20)), 0) << program->error();
  }
  RecordProperty("setup_done_s", std::to_string(setup_done_s));
  RecordProperty("mse_rad2", std::to_string(squares / scored));
}

TEST(Participants, ControlHoldsAndSaysSoWhenTheReferenceDiesAndIdlesOnEstop) {
  Deployment deployment{.domain = "71", .lockstep = false};
  node::StopFlag stop;
  node::Node node(ObserverOptions(deployment));
  auto states = node.MakeReader(node::kJointState);
  auto commands = node.MakeReader(node::kJointCommand);
  auto valves = node.MakeReader(node::kValveCommand);
  auto operator_command = node.MakeWriter(node::kOperatorCommand);

  const auto reference =
      Start(deployment, "reference", {"--config", kRig + "/reference_chirp.yaml"});
  const auto pneumatics = Start(deployment, "pneumatics", {"--config", deployment.pneumatics});
  const auto control = Start(deployment, "control", {"--config", deployment.control});
  const auto provider = Start(deployment, "surrogate", {"--config", kRig + "/surrogate.yaml"});

  const auto wait = [](const auto& condition) {
    const auto limit = std::chrono::steady_clock::now() + seconds(20);
    while (std::chrono::steady_clock::now() < limit) {
      if (condition()) return true;
    }
    return false;
  };
  msg::JointState state;
  msg::JointCommand command;
  const auto look = [&] {
    if (auto message = states.WaitNext(std::chrono::milliseconds(5))) state = std::move(*message);
    while (auto message = commands.TakeNext()) command = std::move(*message);
  };
  ASSERT_TRUE(wait([&] {
    look();
    return command.header.session_id != 0 && command.header.session_id == state.header.session_id;
  })) << provider->error()
      << control->error();
  EXPECT_EQ(command.mode[0], msg::CommandMode::kIdle) << "everything starts disarmed";

  msg::OperatorCommand arm;
  arm.header.session_id = state.header.session_id;
  arm.action = msg::OperatorAction::kArm;
  ASSERT_TRUE(wait([&] {  // events are volatile: said again until heard
    if (state.robot_state == msg::RobotState::kDisarmed)
      static_cast<void>(operator_command.Write(arm));
    look();
    return state.robot_state == msg::RobotState::kArmed &&
           command.mode[0] == msg::CommandMode::kTorque && !command.stale;
  }));

  reference->Signal(SIGKILL);
  EXPECT_TRUE(wait([&] {
    look();
    return command.stale && command.mode[0] == msg::CommandMode::kTorque &&
           command.reference_tick + 10 < command.header.tick;
  })) << "a lost reference is reported, and the joint is held";
  EXPECT_NE(state.robot_state, msg::RobotState::kFault);

  msg::OperatorCommand estop = arm;
  estop.action = msg::OperatorAction::kEstop;
  EXPECT_TRUE(wait([&] {
    if (state.robot_state != msg::RobotState::kEstopped)
      static_cast<void>(operator_command.Write(estop));
    look();
    const auto valve = valves.TakeLatest();
    return state.robot_state == msg::RobotState::kEstopped &&
           command.mode[0] == msg::CommandMode::kIdle && valve && !valve->valve_open[0] &&
           !valve->compressor_on[0];
  }));
  for (Program* program : {control.get(), pneumatics.get(), provider.get()}) {
    program->Signal(SIGINT);
    EXPECT_EQ(program->Wait(seconds(20)), 0) << program->error();
  }
}

TEST(Participants, FollowAPrismaticAxisCommandedInNewtons) {
  const std::string emps = std::string(SINEW_SOURCE_DIR) + "/robots/emps";
  Deployment deployment{.domain = "73"};
  node::StopFlag stop;
  node::Node node(ObserverOptions(deployment));
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto& reference = loop.AddInput(node::kReference);
  auto& command = loop.AddInput(node::kJointCommand);
  // Flow control: the provider waits for the observer, too, so that it misses nothing.
  auto progress = node.MakeWriter(node::kRecordingProgress);
  const auto reference_program =
      Start(deployment, "reference", {"--config", emps + "/reference_sine.yaml"});
  const auto control =
      Start(deployment, "control", {"--config", emps + "/control_pid_linear.yaml"});
  const auto provider = Start(deployment, "world",
                              {"--config", emps + "/world.yaml", "--arm", "--duration", "10",
                               "--await", "joint_command", "--await", "recording_progress:64"});
  double worst_m = 0.0, largest_N = 0.0;
  int scored = 0;
  while (const auto tick = loop.Next()) {
    loop.Publish(progress, msg::RecordingProgress{}, *tick);
    largest_N = std::max(largest_N, std::abs(command.value().motor_torque_Nm[0]));
    if (static_cast<double>(tick->tick) * tick->period_s < 3.0) continue;
    EXPECT_EQ(state.value().joint_kind[0], msg::JointKind::kPrismatic);
    worst_m = std::max(worst_m,
                       std::abs(reference.value().position_rad[0] - state.value().position_rad[0]));
    ++scored;
  }
  EXPECT_GT(scored, 1500);
  EXPECT_LT(worst_m, 2e-3) << "of a stroke of 0.1 m";
  EXPECT_GT(largest_N, 100.0);
  EXPECT_LE(largest_N, 351.5);
  RecordProperty("worst_m", std::to_string(worst_m));
  for (Program* program : {provider.get(), reference_program.get(), control.get()}) {
    EXPECT_EQ(program->Wait(seconds(20)), 0) << program->error();
  }
}

TEST(Participants, BadConfigurationIsOneLineAndExitCode2) {
  const TemporaryFolder folder;
  for (const std::string name : {"reference", "regime", "pneumatics", "control"}) {
    const std::string program = kBin + "/sinew-" + name;
    const std::string bad =
        folder.Write(name + ".yaml", "schema: sinew-" + name + "/1\njoints: [{nonsense: 3}]\n");
    const struct {
      std::vector<std::string> arguments;
      std::string says;
    } kCases[] = {
        {{program, "--log-level", "error", "--domain", "72"}, "--config"},
        {{program, "--log-level", "error", "--domain", "72", "--config", "/absent.yaml"},
         "/absent.yaml"},
        {{program, "--log-level", "error", "--domain", "72", "--config", bad}, name + ".yaml:"},
        {{program, "--log-level", "error", "--domain", "72", "--config", kRig + "/rig.urdf"},
         "rig.urdf"}};
    for (const auto& c : kCases) {
      const testing::Finished finished = testing::Run(c.arguments);
      EXPECT_EQ(finished.exit_code, 2) << name << ": " << finished.error;
      EXPECT_THAT(finished.error, HasSubstr(c.says));
      EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1)
          << finished.error;
    }
  }
}

}  // namespace
}  // namespace sinew
