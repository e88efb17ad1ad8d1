// A state provider whose plant only notes the calls. Domains 51 and 173 to 175.
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/simulation.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "components/node/node.h"
#include "components/provider/participant/run_provider.h"
#include "components/provider/simulated_plant.h"

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

class PushedPlant final : public SimulatedPlant {
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
    disturbance.header().session_id(session_id);
    disturbance.header().origin(msg::ORIGIN_SIM);
    disturbance.joint_count(1);
    disturbance.load_force_N()[0] = force_N;
    EXPECT_EQ(hand.Write(disturbance), node::WriteStatus::kOk);
  };
  const auto state = states.WaitNext(10s);
  for (int i = 0; i < 1000 && hand.matched_readers() == 0; ++i) sender.WaitForData(10ms);
  if (state) {
    push(state->header().session_id() + 1, 1.0);
    push(state->header().session_id(), 2.0);
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
