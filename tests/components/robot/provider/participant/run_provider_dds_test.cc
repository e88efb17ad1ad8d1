// A state provider whose plant only notes the calls. Domains 51, 173 to 175 and 177.
#include <gtest/gtest.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/recording.h>
#include <sinew_idl/simulation.h>
#include <sinew_idl/status.h>

#include <array>
#include <chrono>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "components/robot/provider/participant/run_provider.h"
#include "components/robot/provider/simulated_plant.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"

namespace sinew::provider {
namespace {

using namespace std::chrono_literals;

node::Options OptionsOf(const std::string& name, int domain) {
  node::Options options;
  options.component = options.name = name;
  options.domain_id = domain;
  options.mode = node::TimeMode::kRealtime;
  return options;
}

bool StateIsWritten(const node::Node& witness) {
  for (const node::Endpoint& endpoint : witness.Endpoints()) {
    if (endpoint.is_writer && endpoint.topic == node::kJointState.name) return true;
  }
  return false;
}

class NotedPlant : public Plant {
 public:
  explicit NotedPlant(const node::Node& witness) : witness_(witness) {}
  int joint_count() const override { return 1; }
  std::uint32_t measured_flags() const override { return 0; }
  void Reset(PlantSensors*) override { calls.push_back("reset"); }
  void Step(const PlantCommand&, double, PlantSensors*) override {
    if (++steps == throws_at) throw std::runtime_error("the bus is gone");
  }
  void ShutDown() noexcept override {
    calls.push_back("motors off");
    provider_was_there = StateIsWritten(witness_);
  }

  int steps = 0;
  int throws_at = 0;
  std::vector<std::string> calls;
  bool provider_was_there = false;

 private:
  const node::Node& witness_;
};

const std::vector<std::string> kOrderly = {"reset", "motors off"};

TEST(RunProvider, MotorsAreOffBeforeTheParticipantLeaves) {
  const node::Node witness(OptionsOf("witness", 173));
  NotedPlant plant(witness);
  node::StopFlag stop;
  RunProvider(OptionsOf("provider", 173), stop, {.duration_s = 0.2}, {}, plant);
  EXPECT_GT(plant.steps, 1);
  EXPECT_EQ(plant.calls, kOrderly);
  EXPECT_TRUE(plant.provider_was_there);
}

TEST(RunProvider, MotorsAreOffAfterAnExceptionToo) {
  const node::Node witness(OptionsOf("witness", 174));
  NotedPlant plant(witness);
  plant.throws_at = 20;
  node::StopFlag stop;
  EXPECT_THROW(RunProvider(OptionsOf("provider", 174), stop, {}, {}, plant), std::runtime_error);
  EXPECT_EQ(plant.calls, kOrderly);
  EXPECT_TRUE(plant.provider_was_there);
}

TEST(RunProvider, ASecondProviderTouchesNothing) {
  node::Node first(OptionsOf("first", 175));
  const auto writer = first.MakeWriter(node::kJointState);
  NotedPlant plant(first);
  node::StopFlag stop;
  EXPECT_THROW(RunProvider(OptionsOf("second", 175), stop, {}, {}, plant), UsageError);
  EXPECT_TRUE(plant.calls.empty()) << "its frames would stop the robot of the first";
}

constexpr double kSession_s = 3.0;  // discovery of the other participants included

// A number of its own in every field and on every bus.
class BusPlant final : public NotedPlant {
 public:
  explicit BusPlant(const node::Node& witness) : NotedPlant(witness) {
    report_.bus_count = 3;
    report_.up = {true, false, true, false};
    Number(10, &report_.frames_sent);
    Number(20, &report_.frames_received);
    Number(30, &report_.frames_dropped);
    Number(40, &report_.frames_lost);
    Number(50, &report_.error_frames);
    Number(60, &report_.body_samples_missed);
    Number(70, &report_.body_nodes_lost);
    Number(80, &report_.load_percent);
    Number(90, &report_.answer_p50_us);
    Number(100, &report_.answer_max_us);
    report_.cycle_p50_us = 110.0;
    report_.cycle_max_us = 120.0;
  }
  const BusReport* bus_report() const override { return &report_; }

 private:
  template <class Value>
  static void Number(int first, std::array<Value, BusReport::kMaxBuses>* field) {
    std::iota(field->begin(), field->end(), static_cast<Value>(first));
  }

  BusReport report_;
};

TEST(RunProvider, EveryNumberOfTheBusesReachesBusStatus) {
  node::Node witness(OptionsOf("witness", 173));
  auto buses = witness.MakeReader(node::kBusStatus);
  BusPlant plant(witness);
  node::StopFlag stop;
  std::thread provider([&] {
    RunProvider(OptionsOf("provider", 173), stop, {.duration_s = kSession_s}, {}, plant);
  });
  const auto status = buses.WaitNext(10s);
  provider.join();
  ASSERT_TRUE(status);
  const BusReport& report = *plant.bus_report();
  EXPECT_EQ(status->bus_count, report.bus_count);
  EXPECT_EQ(status->up, report.up);
  EXPECT_EQ(status->frames_sent, report.frames_sent);
  EXPECT_EQ(status->frames_received, report.frames_received);
  EXPECT_EQ(status->frames_dropped, report.frames_dropped);
  EXPECT_EQ(status->frames_lost, report.frames_lost);
  EXPECT_EQ(status->error_frames, report.error_frames);
  EXPECT_EQ(status->body_samples_missed, report.body_samples_missed);
  EXPECT_EQ(status->body_nodes_lost, report.body_nodes_lost);
  EXPECT_EQ(status->load_percent, report.load_percent);
  EXPECT_EQ(status->answer_p50_us, report.answer_p50_us);
  EXPECT_EQ(status->answer_max_us, report.answer_max_us);
  EXPECT_EQ(status->cycle_p50_us, report.cycle_p50_us);
  EXPECT_EQ(status->cycle_max_us, report.cycle_max_us);
}

class PushedPlant : public SimulatedPlant {
 public:
  int joint_count() const override { return 1; }
  std::uint32_t measured_flags() const override { return 0; }
  void Reset(PlantSensors*) override {}
  void Step(const PlantCommand&, double, PlantSensors*) override {}
  void Disturb(const Disturbance& d) override { pushes_N.push_back(d.hand_force_N[0]); }
  void ImposePressure(const ImposedPressure&) override {}
  const GearTruth& gear_truth() const override { return truth_; }

  std::vector<double> pushes_N;

 private:
  GearTruth truth_;
};

class FloatingPlant final : public PushedPlant {
 public:
  FloatingPlant() {
    truth_.position_m = {0.1, 0.2, 0.7};
    truth_.contact_force_N[0] = {1.0, 2.0, 3.0};
    truth_.contact_force_N[7] = {4.0, 5.0, 6.0};
  }
  void DisturbBody(const BodyDisturbance& d) override { disturbances.push_back(d); }
  bool HasDrive(const std::string& joint) const override { return joint == "knee"; }
  const BodyTruth* body_truth() const override { return &truth_; }

  std::vector<BodyDisturbance> disturbances;

 private:
  BodyTruth truth_;
};

const node::Endpoint* FindEndpoint(const std::vector<node::Endpoint>& endpoints,
                                   std::string_view topic, bool is_writer) {
  for (const node::Endpoint& endpoint : endpoints) {
    if (endpoint.topic == topic && endpoint.is_writer == is_writer) return &endpoint;
  }
  return nullptr;
}

TEST(RunProvider, ABodyIsDisturbedInItsSessionAndItsTruthIsPublished) {
  node::Node sender(OptionsOf("sender", 177));
  auto writer = sender.MakeWriter(node::kSimBodyDisturbance);
  auto states = sender.MakeReader(node::kJointState);
  auto truths = sender.MakeReader(node::kSimBodyTruth);
  FloatingPlant plant;
  node::StopFlag stop;
  std::thread provider([&] {
    RunProvider(OptionsOf("provider", 177), stop, {.duration_s = kSession_s}, {}, plant);
  });
  const BodyDisturbance sent{.payload_link = "pelvis",
                             .payload_kg = 4.0,
                             .payload_m = {0.0, 0.01, 0.2},
                             .push_link = std::string(64, 'x'),
                             .push_force_N = {10.0, -20.0, 30.0},
                             .push_m = {0.1, 0.2, 0.3},
                             .lost_drive = "knee",
                             .lost_friction = 0.5};
  const auto send = [&](std::uint64_t session_id, double payload_kg,
                        const std::string& lost_drive = "knee", double lost_friction = 0.5) {
    msg::SimBodyDisturbance message;
    message.header.session_id = session_id;
    message.header.origin = msg::Origin::kSim;
    message.payload_link = sent.payload_link;
    message.payload_kg = payload_kg;
    message.payload_m = sent.payload_m;
    message.push_link = sent.push_link;
    message.push_force_N = sent.push_force_N;
    message.push_m = sent.push_m;
    message.lost_drive = lost_drive;
    message.lost_friction = lost_friction;
    EXPECT_EQ(writer.Write(message), node::WriteStatus::kOk);
  };
  const auto state = states.WaitNext(10s);
  const auto truth = truths.WaitNext(10s);
  for (int i = 0; i < 1000 && writer.matched_readers() == 0; ++i) sender.WaitForData(10ms);
  if (state) {
    const std::uint64_t session_id = state->header.session_id;
    send(session_id + 1, 1.0);
    send(session_id, -1.0);
    send(session_id, std::numeric_limits<double>::quiet_NaN());
    send(session_id, sent.payload_kg, "elbow");
    send(session_id, sent.payload_kg, "knee", 1.5);
    send(session_id, sent.payload_kg);
  }
  provider.join();
  ASSERT_TRUE(state);
  EXPECT_EQ(plant.disturbances, std::vector<BodyDisturbance>{sent});
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->position_m, (std::array{0.1, 0.2, 0.7}));
  EXPECT_EQ(truth->orientation_wxyz, (std::array{1.0, 0.0, 0.0, 0.0}));
  std::array<double, 24> forces_N{};
  for (std::size_t i = 0; i < 3; ++i) {
    forces_N[i] = 1.0 + static_cast<double>(i);
    forces_N[21 + i] = 4.0 + static_cast<double>(i);
  }
  EXPECT_EQ(truth->contact_force_N, forces_N);
}

TEST(RunProvider, AFixedBaseHasNoTopicsOfABody) {
  node::Node witness(OptionsOf("witness", 177));
  auto states = witness.MakeReader(node::kJointState);
  PushedPlant plant;
  node::StopFlag stop;
  std::thread provider([&] {
    RunProvider(OptionsOf("provider", 177), stop, {.duration_s = kSession_s}, {}, plant);
  });
  std::vector<node::Endpoint> endpoints;
  bool last = false;
  while (!last) {  // to the end of the session: its endpoints are known by then
    const auto state = states.WaitNext(10s);
    if (!state) break;
    endpoints = witness.Endpoints();
    last = state->last_tick;
  }
  provider.join();
  EXPECT_TRUE(last);
  EXPECT_NE(FindEndpoint(endpoints, node::kSimPressure.name, false), nullptr);
  EXPECT_NE(FindEndpoint(endpoints, node::kSimTruth.name, true), nullptr);
  EXPECT_EQ(FindEndpoint(endpoints, node::kSimBodyTruth.name, true), nullptr);
  EXPECT_EQ(FindEndpoint(endpoints, node::kSimBodyDisturbance.name, false), nullptr);
}

// Stands upright; from `blind_from` on its IMU says nothing any more. Disarmed: nobody commands.
class StandingPlant final : public NotedPlant {
 public:
  StandingPlant(const node::Node& witness, int blind_from)
      : NotedPlant(witness), blind_from_(blind_from) {}
  int joint_count() const override { return types::kMaxJoints; }
  void Reset(PlantSensors* sensors) override { Read(sensors); }
  void Step(const PlantCommand& command, double, PlantSensors* sensors) override {
    ++steps;
    for (const types::ControlMode mode : command.mode) {
      if (mode != types::ControlMode::kIdle) calls.push_back("moved");
    }
    Read(sensors);
  }
  const BodySensors* body_sensors() const override { return &body_; }

 private:
  void Read(PlantSensors* sensors) {
    sensors->valid.fill(true);
    body_.foot_force_N.fill(20.0);
    body_.foot_valid.fill(true);
    const double noise = 1e-6 * (steps % 2);  // a sensor that is read anew never says the same
    body_.acceleration_m_s2 = {noise, noise, 9.81 + noise};
    body_.angular_velocity_rad_s = {noise, noise, noise};
    body_.imu_valid = steps < blind_from_;
  }

  int blind_from_;
  BodySensors body_;
};

GuardConfig FallsOfTheBiped() {
  const config::Section file = config::Section::Parse(
      "schema: test/1\nguard: {fall: {urdf: " SINEW_SOURCE_DIR "/robots/biped/biped.urdf}}\n",
      "guard.yaml", "test/1");
  return LoadGuardConfig(file.Child("guard"));
}

TEST(RunProvider, ALostImuIsAFaultOfAGuardedRobotWithin100ms) {
  constexpr int kBlindFrom = 720;
  constexpr double kRate_Hz = 240.0;
  node::Options options = OptionsOf("witness", 177);
  options.mode = node::TimeMode::kLockstep;
  node::Node witness(options);
  auto states = witness.MakeReader(node::kJointState);
  auto statuses = witness.MakeReader(node::kComponentStatus);
  auto answers = witness.MakeWriter(node::kRecordingProgress);  // so that no state is missed
  StandingPlant plant(witness, kBlindFrom);
  node::StopFlag stop;
  options.component = options.name = "provider";
  ProviderOptions run;
  run.duration_s = 4.0;
  run.await = {"recording_progress"};
  std::thread provider([&] { RunProvider(options, stop, run, FallsOfTheBiped(), plant); });
  std::optional<std::uint64_t> fault_tick;
  bool last = false;
  while (!last) {
    const auto state = states.WaitNext(20s);
    if (!state) break;
    if (!fault_tick && state->robot_state == msg::RobotState::kFault)
      fault_tick = state->header.tick;
    last = state->last_tick;
    msg::RecordingProgress answer;
    answer.header = state->header;
    EXPECT_EQ(answers.Write(answer), node::WriteStatus::kOk);
  }
  provider.join();
  std::string message;
  while (const auto status = statuses.TakeNext()) {
    if (status->message.find("fall") != std::string::npos) {
      message = status->message;
    }
  }
  ASSERT_TRUE(fault_tick);
  EXPECT_GT(*fault_tick, static_cast<std::uint64_t>(kBlindFrom));
  EXPECT_LE(static_cast<double>(*fault_tick) - kBlindFrom, 0.1 * kRate_Hz);
  EXPECT_EQ(message, "fall: not known, lost: imu");
}

TEST(RunProvider, AGuardAgainstFallsNeedsSensorsOfTheBodyAndTheRobotsJoints) {
  const node::Node witness(OptionsOf("witness", 177));
  const auto error_of = [&](Plant& plant, double rate_Hz) -> std::string {
    node::StopFlag stop;
    try {
      RunProvider(OptionsOf("provider", 177), stop, {.rate_Hz = rate_Hz}, FallsOfTheBiped(), plant);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  };
  using ::testing::HasSubstr;
  NotedPlant without(witness);
  EXPECT_THAT(error_of(without, 240.0), HasSubstr("measures neither feet nor torso"));
  EXPECT_TRUE(without.calls.empty());
  StandingPlant slow(witness, 0);
  EXPECT_THAT(error_of(slow, 10.0), HasSubstr("guard.fall: ")) << "no tick in 100 ms";
}

TEST(RunProvider, ArmingAtTheStartWaitsForAControllerAndTheRobotIdlesUntilThen) {
  node::Node controller(OptionsOf("controller", 177));
  auto states = controller.MakeReader(node::kJointState);
  PushedPlant plant;
  node::StopFlag stop;
  std::thread provider([&] {
    // A guard that bears the pauses of a busy machine.
    RunProvider(OptionsOf("provider", 177), stop, {.duration_s = kSession_s, .arm = true},
                {.missed_periods = 100, .fault_after = 1000ms}, plant);
  });
  std::optional<node::Writer<msg::JointCommand>> commands;
  bool alone = false, armed = false, last = false;
  while (!last) {
    const auto state = states.WaitNext(10s);
    if (!state) break;
    EXPECT_NE(state->robot_state, msg::RobotState::kFault) << state->header.tick;
    if (!commands) EXPECT_EQ(state->robot_state, msg::RobotState::kDisarmed);
    alone = alone || !commands;
    if (!commands && state->header.tick > 240) {
      commands.emplace(controller.MakeWriter(node::kJointCommand));
    }
    if (commands) {
      msg::JointCommand answer;
      answer.header = state->header;
      answer.joint_count = 1;
      EXPECT_EQ(commands->Write(answer), node::WriteStatus::kOk);
    }
    armed = armed || state->robot_state == msg::RobotState::kArmed;
    last = state->last_tick;
  }
  provider.join();
  EXPECT_TRUE(alone);
  EXPECT_TRUE(armed);
  EXPECT_TRUE(last);
}

// The last one: a stop that was requested is one for the whole process.
TEST(RunProvider, ADisturbanceOfAnotherSessionIsRefused) {
  node::Node sender(OptionsOf("sender", 51));
  auto hand = sender.MakeWriter(node::kSimDisturbance);
  auto states = sender.MakeReader(node::kJointState);
  PushedPlant plant;
  node::StopFlag stop;
  std::thread provider(
      [&] { RunProvider(OptionsOf("provider", 51), stop, {.duration_s = 30.0}, {}, plant); });
  const auto push = [&](std::uint64_t session_id, double force_N) {
    msg::SimDisturbance disturbance;
    disturbance.header.session_id = session_id;
    disturbance.header.origin = msg::Origin::kSim;
    disturbance.joint_count = 1;
    disturbance.load_force_N[0] = force_N;
    EXPECT_EQ(hand.Write(disturbance), node::WriteStatus::kOk);
  };
  const auto state = states.WaitNext(10s);
  for (int i = 0; i < 1000 && hand.matched_readers() == 0; ++i) sender.WaitForData(10ms);
  if (state) {
    push(state->header.session_id + 1, 1.0);
    push(state->header.session_id, 2.0);
    // Both were there before this: a state of a later tick is written after they were taken.
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(states.WaitNext(10s));
  }
  stop.Request();
  provider.join();
  ASSERT_TRUE(state);
  EXPECT_EQ(plant.pushes_N, std::vector<double>{2.0});
}

}  // namespace
}  // namespace sinew::provider
