// A state provider whose plant only notes the calls. Domains 173 to 175.
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "components/node/node.h"
#include "components/provider/participant/run_provider.h"

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

}  // namespace
}  // namespace sinew::provider
