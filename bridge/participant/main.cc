// sinew-can-bridge: the state provider of a robot whose joints are on CAN.
#include <spdlog/spdlog.h>

#include <memory>

#include "bridge/joints/braking.h"
#include "bridge/joints/can_plant.h"
#include "bridge/joints/file/bridge_config.h"
#include "components/node/options.h"
#include "components/provider/participant/run_provider.h"

namespace {

using namespace sinew;

void LogBraking(const bridge::BridgeConfig& config, double period_s) {
  for (const bridge::JointConfig& joint : config.joints) {
    const bridge::Envelope e = bridge::EnvelopeOf(joint, period_s);
    if (!e.brakes()) {
      spdlog::warn(
          "joint '{}': no limits.braking: torque towards a position limit is taken away "
          "within {:.2f} rad of it, but nothing brakes",
          joint.name, joint.limits.margin_rad);
      continue;
    }
    spdlog::info(
        "joint '{}': brakes at {:.1f} rad/s^2 before a position limit, a load may hold it "
        "{:.3f} rad beyond",
        joint.name, e.deceleration_rad_s2, e.load_beyond_rad);
    if (e.load_beyond_rad >= joint.limits.margin_rad) {
      spdlog::warn("joint '{}': that is more than margin_rad, {:.3f} rad: a fault of the joint",
                   joint.name, joint.limits.margin_rad);
    }
  }
}

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
  LogBraking(file.bridge, 1.0 / provider_options.rate_Hz);
  provider::RunProvider(options, stop, provider_options, guard, plant);
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
