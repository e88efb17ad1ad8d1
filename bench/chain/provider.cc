// A state provider without physics, for the latency of a chain: sensors of one joint that swings
// forever, a plant that acts as soon as it has its command. With --component the chain runs in its
// thread. Prints how long after the write of joint_state the joint_command was decoded.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "components/node/options.h"
#include "components/provider/participant/run_provider.h"
#include "tools/compose/chain.h"

namespace {

using namespace sinew;

class SwingingJoint final : public provider::Plant {
 public:
  int joint_count() const override { return 1; }
  std::uint32_t measured_flags() const override { return ~0u; }
  bool acts_at_once() const override { return true; }
  void Reset(provider::PlantSensors* sensors) override { Read(sensors); }
  void Step(const provider::PlantCommand&, double period_s,
            provider::PlantSensors* sensors) override {
    time_s_ += period_s;
    Read(sensors);
  }

 private:
  void Read(provider::PlantSensors* sensors) const {
    sensors->position_rad[0] = 0.5 * std::sin(time_s_);
    sensors->velocity_rad_s[0] = 0.5 * std::cos(time_s_);
    sensors->motor_position_rad[0] = 100.0 * sensors->position_rad[0];
    sensors->motor_velocity_rad_s[0] = 100.0 * sensors->velocity_rad_s[0];
    sensors->chamber_pressure_bar[0] = sensors->reservoir_pressure_bar[0] = 4.0;
    sensors->valve_open[0] = true;
    sensors->valid[0] = true;
  }
  double time_s_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  provider::ProviderOptions options;
  std::vector<std::string> components;
  const auto body = [&](const node::Options& node_options, node::StopFlag& stop) {
    std::vector<compose::Part> parts;
    for (const std::string& text : components) parts.push_back(compose::ParsePart(text));
    compose::Chain chain(node_options, stop, parts);
    node::Options own = node_options;
    if (!parts.empty()) {
      options.composed = &chain;
      own.composition = &chain.composition();
    }
    provider::WorkTime answers;
    options.answers = &answers;
    SwingingJoint plant;
    provider::RunProvider(own, stop, options, provider::GuardConfig{}, plant);
    std::printf("{\"cycles\": %llu, \"p50_us\": %.0f, \"p999_us\": %.0f}\n",
                static_cast<unsigned long long>(answers.cycles()), answers.Quantile_us(0.5),
                answers.Quantile_us(0.999));
  };
  return node::RunParticipant(argc, argv, "surrogate", "A state provider for bench/chain", body,
                              [&](CLI::App& app) {
                                provider::AddProviderOptions(app, &options);
                                app.add_option("--component", components, "NAME=PROGRAM=CONFIG");
                              });
}
