#include "bench/payloads/provider_member.h"

#include <cmath>
#include <string>
#include <utility>

#include "components/record/logger/recorder.h"
#include "components/robot/provider/participant/command_readers.h"
#include "components/robot/provider/participant/provider_options.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/topics/node/node.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"

namespace sinew::payloads {
namespace {

constexpr double kProviderRate_Hz = 240.0;

struct ProviderConfig {
  surrogate::RigParameters rig;
  provider::CycleConfig cycle;
};

ProviderConfig LoadProvider(const node::Options& options, std::uint64_t session_id) {
  const config::Section file = surrogate::OpenSurrogate(options.config_path);
  ProviderConfig config;
  config.rig = surrogate::ReadRig(file);
  config.cycle.guard = provider::LoadGuardConfig(file.ChildOrEmpty("guard"));
  config.cycle.session_id = session_id;
  config.cycle.rate_Hz = kProviderRate_Hz;
  config.cycle.simulated_time = true;
  return config;
}

// The surrogate with a base that nothing moves, for the topics of a floating one.
class FloatingSurrogate final : public surrogate::Surrogate {
 public:
  using Surrogate::Surrogate;
  void DisturbBody(const provider::BodyDisturbance& disturbance) override {
    if (!provider::IsPossible(disturbance)) {
      throw Violation("the plant gets a disturbance that is not possible");
    }
  }
  const provider::BodyTruth* body_truth() const override { return &body_truth_; }

 private:
  provider::BodyTruth body_truth_;
};

class ProviderMember final : public node::Component {
 public:
  ProviderMember(const node::Options& options, Environment& environment,
                 const ProviderConfig& config)
      : environment_(environment),
        plant_(config.rig),
        cycle_(config.cycle),
        node_(options),
        readers_(node_, cycle_, plant_,
                 [](provider::OperatorResult, types::OperatorAction, std::string_view) {
                   return std::string();
                 }) {
    plant_.Reset(&sensors_);
    cycle_.ArmAtStart();
  }

  bool Ready() override { return environment_.tick != tick_; }
  bool Step() override {
    tick_ = environment_.tick;
    (void)cycle_.Begin(tick_, 0);
    readers_.TakeOperatorCommands(tick_);
    readers_.PublishSource(cycle_.Header(tick_, 0));
    readers_.TakeAll(tick_);
    const provider::PlantCommand& command = cycle_.Command(tick_, sensors_);
    for (std::size_t j = 0; j < command.mode.size(); ++j) {
      if (std::isfinite(command.motor_torque_Nm[j]) && std::isfinite(command.position_rad[j]) &&
          std::isfinite(command.velocity_rad_s[j])) {
        continue;
      }
      throw Violation("the plant gets a command that is not finite");
    }
    plant_.Step(command, cycle_.period_s(), &sensors_);
    for (std::size_t j = 0; j < static_cast<std::size_t>(plant_.joint_count()); ++j) {
      if (std::isfinite(sensors_.position_rad[j]) && std::isfinite(sensors_.velocity_rad_s[j]) &&
          std::isfinite(sensors_.chamber_pressure_bar[j])) {
        continue;
      }
      throw Violation("the simulated plant's sensors are not finite");
    }
    (void)cycle_.Observe(sensors_);
    return true;
  }

 private:
  Environment& environment_;
  std::uint64_t tick_ = 0;
  FloatingSurrogate plant_;
  provider::ProviderCycle cycle_;
  provider::PlantSensors sensors_;
  node::Node node_;
  provider::CommandReaders readers_;
};

class CountingSink final : public logger::RecordingSink {
 public:
  recording::IoStatus Begin(int) override { return recording::IoStatus::Ok(); }
  recording::IoStatus Sync() override { return recording::IoStatus::Ok(); }
  recording::IoStatus End() override { return recording::IoStatus::Ok(); }
  recording::IoStatus Write(std::span<const std::byte> bytes) override {
    bytes_ += bytes.size();
    return recording::IoStatus::Ok();
  }

 private:
  std::uint64_t bytes_ = 0;
};

std::vector<recording::TopicSchema> Schemas() {
  std::vector<recording::TopicSchema> schemas;
  schemas.reserve(node::AllTopics().size());
  for (const node::TopicInfo& topic : node::AllTopics()) {
    schemas.push_back({topic.name, topic.type_name, topic.idl, topic.idl_hash});
  }
  return schemas;
}

logger::RecorderOptions WaitingRecorder() {
  logger::RecorderOptions options;
  options.wait_for_capacity = true;
  return options;
}

class LoggerMember final : public node::Component {
 public:
  explicit LoggerMember(const node::Options& options)
      : recorder_(sink_, Schemas(), {}, WaitingRecorder()), node_(options) {
    for (std::size_t i = 0; i < node::AllTopics().size(); ++i) {
      node_.ReadRaw(node::AllTopics()[i], [this, i](node::RawSample&& sample) {
        (void)recorder_.Offer(i, std::move(sample.payload), sample.reception_stamp_ns);
      });
    }
  }

  bool Ready() override { return false; }  // its work is done as samples come, and in its thread
  bool Step() override { return true; }

 private:
  CountingSink sink_;
  logger::Recorder recorder_;
  node::Node node_;
};

}  // namespace

std::unique_ptr<node::Component> MakeProvider(const node::Options& options,
                                              Environment& environment) {
  return std::make_unique<ProviderMember>(options, environment,
                                          LoadProvider(options, environment.provider_session));
}

std::unique_ptr<node::Component> MakeLogger(const node::Options& options, Environment&) {
  return std::make_unique<LoggerMember>(options);
}

}  // namespace sinew::payloads
