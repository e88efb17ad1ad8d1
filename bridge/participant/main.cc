// sinew-can-bridge: the state provider of a robot whose joints are on CAN.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "bridge/joints/braking.h"
#include "bridge/joints/can_plant.h"
#include "bridge/joints/file/bridge_config.h"
#include "bridge/participant/prove_watchdogs.h"
#include "components/robot/estop/estop_config.h"
#include "components/robot/estop/latch_file.h"
#include "components/robot/provider/participant/run_provider.h"
#include "components/topics/node/options.h"

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
         const provider::ProviderOptions& provider_options, bool prove_watchdogs) {
  if (options.config_path.empty())
    throw UsageError("--config: the joint map is needed, e.g. robots/rig/can_bridge.yaml");
  if (options.mode == node::TimeMode::kLockstep) {
    throw UsageError(
        "--lockstep: a bus has its own time; use world or surrogate for simulated time");
  }
  const config::Section section = config::Section::Load(options.config_path, bridge::kSchema);
  auto file = config::Read<bridge::BridgeFile>(section);
  const bool hardware = file.bridge.live;
  const provider::GuardConfig guard = provider::LoadGuardConfig(section.ChildOrEmpty("guard"));
  const estop::Config estop =
      estop::LoadConfig(section.ChildOrEmpty("estop"), options.name, options.domain_id, hardware);
  const std::filesystem::path proofs = bridge::ProofPath(section, file);
  section.RejectUnknownKeys();
  // Before the first frame, and until the last.
  std::vector<std::optional<can::BusMaster>> masters;
  for (const can::BusEntry& bus : file.buses) masters.push_back(can::CommandBus(bus));
  if (prove_watchdogs) {
    if (estop.latch) {
      if (const auto latch = estop::LatchFile(*estop.latch).Read(); latch.latched) {
        throw UsageError("--prove-watchdogs: the estop is latched (" + latch.why +
                         "); 'sinew reset' first");
      }
    }
    bridge::ProveWatchdogs(file, proofs, [&stop] { return stop.requested(); });
    return;
  }
  file.bridge.arm_refusal = bridge::ArmRefusal(file.bridge, proofs, options.config_path.string());

  std::vector<std::unique_ptr<can::Transport>> transports;
  std::vector<can::Transport*> pointers;
  for (std::size_t b = 0; b < file.buses.size(); ++b) {
    const bool others = file.buses[b].kind != can::TransportKind::kReplay;
    transports.push_back(can::OpenBus(
        file.buses[b], bridge::ReceiveFilters(file.bridge, static_cast<int>(b), others)));
    pointers.push_back(transports.back().get());
  }
  bridge::CanPlant plant(file.bridge, pointers);
  spdlog::info("{} joints on {} buses, {}", file.bridge.joints.size(), file.buses.size(),
               file.bridge.live ? "live" : "simulated");
  if (!file.bridge.arm_refusal.empty()) {
    spdlog::warn("cannot be armed: {}", file.bridge.arm_refusal);
  }
  LogBraking(file.bridge, 1.0 / provider_options.rate_Hz);
  provider::RunProvider(options, stop, provider_options, guard, plant, estop);
  for (const can::Transport* bus : pointers) {
    const can::TransportCounters counters = bus->counters();
    spdlog::info("bus '{}': {} frames sent, {} received, {} dropped, {} error frames", bus->name(),
                 counters.sent, counters.received, counters.dropped, counters.error_frames);
  }
  for (const bridge::BodyMeasurement& node : plant.body_nodes()) {
    const bridge::BodyCounts counts = node.counts();
    spdlog::info("{} of node {}: lost {} times, {} samples missed{}",
                 can::BodyPartName(node.config().part), node.config().node, counts.lost,
                 counts.samples_missed, node.heartbeat() ? "" : ", no heartbeat");
    if (node.heartbeat() && node.heartbeat()->version != can::kNodeFramesVersion) {
      spdlog::warn("{} of node {}: frames of version {}, expected {}: never valid",
                   can::BodyPartName(node.config().part), node.config().node,
                   node.heartbeat()->version, can::kNodeFramesVersion);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  provider::ProviderOptions provider_options;
  bool prove_watchdogs = false;
  return node::RunParticipant(
      argc, argv, "can-bridge", "State provider of a robot whose joints are on CAN",
      [&](const node::Options& options, node::StopFlag& stop) {
        Run(options, stop, provider_options, prove_watchdogs);
      },
      [&](CLI::App& app) {
        provider::AddProviderOptions(app, &provider_options);
        node::AddFlag(app, "--prove-watchdogs", &prove_watchdogs,
                      "Withhold the setpoints of each axis in turn and keep the proof that its "
                      "watchdog idles it, then end");
      });
}
