// A state provider without physics, for the latency of a chain: sensors of one joint that swings
// within 0.05 rad of its reference for ever, and a plant that acts as soon as it has its command.
// With --component the chain runs in its thread, as under sinew-compose. Measured: how long after
// the write of joint_state the joint_command is decoded, in the cycles of --seconds after the
// warm-up, and the work of a cycle without its waits. A command that does not come until the
// provider gives up counts as 20 ms and is late.
//
// Prints "warm" before the measured time, when it can be armed, and the result after it, and runs
// for a while after each: then counts can be asked for with `sinew list`. With --sizes it also
// prints the encoded bytes of every topic, as recorders get them.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "components/robot/provider/participant/run_provider.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"
#include "components/topics/node/topics.h"
#include "tools/compose/chain.h"

namespace {

using namespace sinew;

constexpr double kWarm_s = 1.5, kBegin_s = 6.0, kAfter_s = 3.0;

class SwingingJoint final : public provider::Plant {
 public:
  SwingingJoint(double seconds, provider::WorkTime* answers, provider::WorkTime* work)
      : end_s_(kBegin_s + seconds), answers_(answers), work_(work) {}
  int joint_count() const override { return 1; }
  std::uint32_t measured_flags() const override { return ~0u; }
  bool acts_at_once() const override { return true; }
  void Reset(provider::PlantSensors* sensors) override { Read(sensors); }
  void Step(const provider::PlantCommand&, double period_s,
            provider::PlantSensors* sensors) override {
    const double before_s = time_s_;
    time_s_ += period_s;
    if (before_s < kWarm_s && time_s_ >= kWarm_s) {
      std::puts("warm");
      std::fflush(stdout);
    }
    if (before_s >= kBegin_s && before_s < end_s_) ++cycles_;
    if (before_s < kBegin_s && time_s_ >= kBegin_s) {
      *answers_ = provider::WorkTime();
      *work_ = provider::WorkTime();
    }
    if (before_s < end_s_ && time_s_ >= end_s_) PrintResult();
    Read(sensors);
  }

 private:
  void PrintResult() {
    const std::uint64_t answered = answers_->cycles();
    const std::uint64_t late = cycles_ > answered ? cycles_ - answered : 0;
    for (std::uint64_t k = 0; k < late; ++k) {
      answers_->Resume(0);
      answers_->Pause(20'000'000);
      answers_->EndCycle();
    }
    std::printf(
        "{\"cycles\": %llu, \"late\": %llu, \"p50_us\": %.0f, \"p999_us\": %.0f, "
        "\"work_p50_us\": %.0f, \"work_p999_us\": %.0f}\n",
        static_cast<unsigned long long>(cycles_), static_cast<unsigned long long>(late),
        answers_->Quantile_us(0.5), answers_->Quantile_us(0.999), work_->Quantile_us(0.5),
        work_->Quantile_us(0.999));
    std::fflush(stdout);
  }
  void Read(provider::PlantSensors* sensors) const {
    constexpr double kAmplitude_rad = 0.05, kSpeed_rad_s = 2.5, kGear = 100.0;
    sensors->position_rad[0] = kAmplitude_rad * std::sin(kSpeed_rad_s * time_s_);
    sensors->velocity_rad_s[0] = kAmplitude_rad * kSpeed_rad_s * std::cos(kSpeed_rad_s * time_s_);
    sensors->motor_position_rad[0] = kGear * sensors->position_rad[0];
    sensors->motor_velocity_rad_s[0] = kGear * sensors->velocity_rad_s[0];
    sensors->chamber_pressure_bar[0] = sensors->reservoir_pressure_bar[0] = 4.0;
    sensors->valve_open[0] = true;
    sensors->valid[0] = true;
  }
  const double end_s_;
  provider::WorkTime* answers_;
  provider::WorkTime* work_;
  double time_s_ = 0.0;
  std::uint64_t cycles_ = 0;  // of the measured time
};

// The largest payload of every topic, by a reader of each in a participant of its own.
class PayloadSizes {
 public:
  explicit PayloadSizes(node::Options options) : node_(Renamed(std::move(options))) {
    for (const node::TopicInfo& topic : node::AllTopics()) {
      node_.ReadRaw(topic, [this](node::RawSample&& sample) {
        const std::lock_guard<std::mutex> lock(mutex_);
        std::size_t& bytes = bytes_[sample.topic];
        bytes = std::max(bytes, sample.payload.size());
      });
    }
  }
  void Print() {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::printf("{");
    const char* separator = "";
    for (const auto& [topic, bytes] : bytes_) {
      std::printf("%s\"%s\": %zu", separator, topic.c_str(), bytes);
      separator = ", ";
    }
    std::printf("}\n");
  }

 private:
  static node::Options Renamed(node::Options options) {
    options.name += "_sizes";
    options.composition = nullptr;
    return options;
  }
  std::mutex mutex_;
  std::map<std::string, std::size_t> bytes_;  // by topic
  node::Node node_;                           // ends before what its callbacks use
};

}  // namespace

int main(int argc, char** argv) {
  provider::ProviderOptions options;
  std::vector<std::string> components;
  double seconds = 10.0;
  bool sizes = false;
  const auto body = [&](const node::Options& node_options, node::StopFlag& stop) {
    std::vector<compose::Part> parts;
    for (const std::string& text : components) parts.push_back(compose::ParsePart(text));
    compose::Chain chain(node_options, stop, parts);
    node::Options own = node_options;
    if (!parts.empty()) {
      options.composed = &chain;
      own.composition = &chain.composition();
    }
    std::optional<PayloadSizes> payloads;
    if (sizes) payloads.emplace(node_options);
    provider::WorkTime answers, work;
    options.answers = &answers;
    options.work = &work;
    options.duration_s = kBegin_s + seconds + kAfter_s;
    SwingingJoint plant(seconds, &answers, &work);
    provider::RunProvider(own, stop, options, provider::GuardConfig{}, plant);
    if (payloads) payloads->Print();
  };
  return node::RunParticipant(
      argc, argv, "surrogate", "A state provider for bench/chain", body, [&](CLI::App& app) {
        app.add_option("--rate", options.rate_Hz, "Cycles per second");
        app.add_option("--seconds", seconds, "How long to measure");
        app.add_flag("--sizes", sizes, "Print the encoded bytes of every topic");
        app.add_option("--component", components, "NAME=PROGRAM=CONFIG");
      });
}
