#include "bench/rerun/rig_recording.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "components/record/logger/file/file_series.h"
#include "components/record/logger/recorder.h"
#include "components/robot/provider/participant/command_readers.h"
#include "components/robot/provider/participant/provider_options.h"
#include "components/robot/provider/participant/state_publisher.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/topics/node/component.h"
#include "components/topics/node/composition.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"

namespace sinew::rerun {
namespace {

constexpr double kRigRate_Hz = 240.0;

std::vector<recording::TopicSchema> SchemasOfAllTopics() {
  std::vector<recording::TopicSchema> schemas;
  schemas.reserve(node::AllTopics().size());
  for (const node::TopicInfo& topic : node::AllTopics()) {
    schemas.push_back({topic.name, topic.type_name, topic.idl, topic.idl_hash});
  }
  return schemas;
}

surrogate::RigParameters RigOf(const config::Section& file, std::uint64_t seed) {
  surrogate::RigParameters rig = surrogate::ReadRig(file);
  rig.seed = seed;
  return rig;
}

provider::CycleConfig CycleOf(const config::Section& file, const RigRecordingOptions& options) {
  provider::CycleConfig cycle;
  cycle.guard = provider::LoadGuardConfig(file.ChildOrEmpty("guard"));
  cycle.session_id = provider::SessionFromSeed(options.seed);
  cycle.rate_Hz = kRigRate_Hz;
  cycle.duration_s = static_cast<double>(options.ticks) / kRigRate_Hz;
  cycle.simulated_time = true;
  return cycle;
}

class RecordedRig {
 public:
  RecordedRig(const RigRecordingOptions& options, const config::Section& surrogate)
      : options_(options),
        files_(options.out, /*numbered=*/false, recording::Existing::kReplace),
        recorder_(
            files_, SchemasOfAllTopics(),
            {{"sinew.recording",
              {{"mode", options.mode == node::TimeMode::kLockstep ? "lockstep" : "realtime"}}}},
            logger::RecorderOptions{.wait_for_capacity = true}),
        recorder_node_(Named("logger")),
        operators_(Named("operator")),
        plant_(RigOf(surrogate, options.seed)),
        cycle_(CycleOf(surrogate, options)),
        provider_node_(Named("surrogate")),
        readers_(provider_node_, cycle_, plant_,
                 [](provider::OperatorResult, types::OperatorAction, std::string_view) {
                   return std::string();
                 }),
        publisher_(provider_node_, plant_) {
    for (std::size_t i = 0; i < node::AllTopics().size(); ++i) {
      recorder_node_.ReadRaw(node::AllTopics()[i], [this, i](node::RawSample&& sample) {
        // Simulated reception times: the order of the file is that of the chain.
        (void)recorder_.Offer(i, std::move(sample.payload), ++received_);
      });
    }
    for (const std::string& program : compose::ComposedPrograms()) {
      for (const compose::Part& part : PartsOfTheRig(options.rig)) {
        if (part.program == program) {
          components_.push_back({part.name, compose::MakePart(part, Named(part.name), stop_)});
        }
      }
    }
  }

  void Run() {
    plant_.Reset(&sensors_);
    cycle_.ArmAtStart();
    for (std::uint64_t tick = 0; tick < options_.ticks && !stop_.requested(); ++tick) {
      composition_.SetSettled(tick >= options_.joining_ticks);
      if (options_.before) options_.before(operators_, cycle_.session_id(), tick);
      (void)cycle_.Begin(tick, 0);
      readers_.TakeOperatorCommands(tick);
      publisher_.Publish(cycle_.Header(tick, 0), cycle_.state(), cycle_.fault(), cycle_.last(tick),
                         cycle_.period_s(), sensors_);
      for (const auto& [name, component] : components_) {
        if (options_.misses && options_.misses(name, tick)) continue;
        if (component->Ready()) (void)component->Step();
      }
      readers_.TakeAll(tick);
      plant_.Step(cycle_.Command(tick, sensors_), cycle_.period_s(), &sensors_);
      (void)cycle_.Observe(sensors_);
    }
    components_.clear();
    const recording::IoStatus written = recorder_.Finish();
    if (!written.ok()) {
      throw std::runtime_error(options_.out.string() + ": cannot be written");
    }
  }

 private:
  node::Options Named(const std::string& name) {
    node::Options options;
    options.component = options.name = name;
    options.mode = options_.mode;
    options.composition = &composition_;
    return options;
  }

  const RigRecordingOptions options_;
  node::StopFlag stop_;
  node::Composition composition_{node::Composition::Reach::kApart};
  logger::FileSeries files_;
  logger::Recorder recorder_;
  std::int64_t received_ = 0;
  node::Node recorder_node_, operators_;
  surrogate::Surrogate plant_;
  provider::ProviderCycle cycle_;
  provider::PlantSensors sensors_;
  node::Node provider_node_;
  provider::CommandReaders readers_;
  provider::StatePublisher publisher_;
  std::vector<std::pair<std::string, std::unique_ptr<node::Component>>> components_;
};

}  // namespace

std::vector<compose::Part> PartsOfTheRig(const std::filesystem::path& rig) {
  return {{"pneumatics", "sinew-pneumatics", rig / "pneumatics.yaml"},
          {"regime", "sinew-regime", rig / "regime.yaml"},
          {"reference", "sinew-reference", rig / "reference_benchmark.yaml"},
          {"esn", "sinew-esn", rig / "esn_adaptive.yaml"},
          {"rls", "sinew-rls", rig / "rls.yaml"},
          {"control", "sinew-control", rig / "control_pid_esn.yaml"}};
}

void RecordRig(const RigRecordingOptions& options) {
  const config::Section surrogate = surrogate::OpenSurrogate(options.rig / "surrogate.yaml");
  RecordedRig(options, surrogate).Run();
}

}  // namespace sinew::rerun
