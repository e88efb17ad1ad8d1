// sinew-can-bridge: the state provider of a robot whose joints are on CAN.
#include <spdlog/spdlog.h>

#include <memory>

#include "bridge/joints/can_plant.h"
#include "bridge/joints/file/bridge_config.h"
#include "components/estop/estop_config.h"
#include "components/node/options.h"
#include "components/provider/participant/run_provider.h"

namespace {

using namespace sinew;

void Run(const node::Options& options, node::StopFlag& stop,
         const provider::ProviderOptions& provider_options) {
  if (options.config_path.empty())
    throw UsageError("--config: the joint map is needed, e.g. robots/rig/can_bridge.yaml");
  if (options.mode == node::TimeMode::kLockstep) {
    throw UsageError(
        "--lockstep: a bus has its own time; use world or surrogate for simulated time");
  }
  const config::Section section = config::Section::Load(options.config_path, "sinew-can-bridge/1");
  const bridge::BridgeFile file = bridge::ReadBridge(section);
  const provider::GuardConfig guard = provider::LoadGuardConfig(section.ChildOrEmpty("guard"));
  const estop::Config estop =
      estop::LoadConfig(section.ChildOrEmpty("estop"), options.domain_id, file.bridge.live);
  section.RejectUnknownKeys();

  std::vector<std::unique_ptr<can::Transport>> transports;
  std::vector<can::Transport*> pointers;
  for (std::size_t b = 0; b < file.buses.size(); ++b) {
    transports.push_back(
        can::OpenBus(file.buses[b], bridge::ReceiveFilters(file.bridge, static_cast<int>(b))));
    pointers.push_back(transports.back().get());
  }
  bridge::CanPlant plant(file.bridge, pointers);
  spdlog::info("{} joints on {} buses, {}", file.bridge.joints.size(), file.buses.size(),
               file.bridge.live ? "live" : "simulated");
  provider::RunProvider(options, stop, provider_options, guard, plant, estop);
  for (const can::Transport* bus : pointers) {
    const can::TransportCounters counters = bus->counters();
    spdlog::info("bus '{}': {} frames sent, {} received, {} dropped, {} error frames", bus->name(),
                 counters.sent, counters.received, counters.dropped, counters.error_frames);
  }
}

}  // namespace

int main(int argc, char** argv) {
  provider::ProviderOptions provider_options;
  return node::RunParticipant(
      argc, argv, "can-bridge", "State provider of a robot whose joints are on CAN",
      [&](const node::Options& options, node::StopFlag& stop) {
        Run(options, stop, provider_options);
      },
      [&](CLI::App& app) { provider::AddProviderOptions(app, &provider_options); });
}
