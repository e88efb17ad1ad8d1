// sinew-virtual-axes: motor controllers and sensor nodes on buses, with the surrogate or a world
// behind them.
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>
#include <stdexcept>

#include "bridge/virtual_axes/file/virtual_axes_config.h"
#include "bridge/virtual_axes/participant/simulation_topics.h"
#include "bridge/virtual_axes/virtual_axes.h"
#include "components/base/types/clock/clock.h"
#include "components/topics/node/options.h"
#include "components/topics/node/realtime.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"
#include "sim/world/file/world_file.h"

namespace {

using namespace sinew;

// The plant behind the axes: rigs side by side, or a world.
std::unique_ptr<provider::SimulatedPlant> MakePlant(const virtual_axes::VirtualAxesFile& file,
                                                    const node::Options& options,
                                                    const std::vector<std::string>& effects) {
  if (!file.world_path.empty()) {
    if (!effects.empty()) throw UsageError("--effect: only the surrogate has undeclared effects");
    world::WorldFile world = world::LoadWorldFile(file.world_path);
    world.seed = options.seed;
    return world::MakeWorld(world, file.world_path);
  }
  surrogate::RigParameters rig = surrogate::LoadRig(file.surrogate_path);
  rig.seed = options.seed;
  if (!effects.empty()) rig.effects = surrogate::ParseEffects(effects);
  return std::make_unique<surrogate::Surrogate>(rig, file.joints);
}

void Run(const node::Options& options, node::StopFlag& stop,
         const std::vector<std::string>& effects,
         const virtual_axes::SimulationTopicsOptions& topics) {
  if (options.config_path.empty()) {
    throw UsageError("--config: the axes are needed, e.g. robots/rig/virtual_axes.yaml");
  }
  auto file = config::Read<virtual_axes::VirtualAxesFile>(
      config::Section::Load(options.config_path, virtual_axes::kSchema));
  file.axes.seed = options.seed;
  const std::unique_ptr<provider::SimulatedPlant> simulated = MakePlant(file, options, effects);
  provider::SimulatedPlant& plant = *simulated;

  try {
    virtual_axes::CheckVirtualAxesConfig(file.axes, plant.joint_count(),
                                         static_cast<int>(file.buses.size()));
  } catch (const std::invalid_argument& error) {
    throw UsageError(options.config_path.string() + ": " + error.what());
  }
  std::vector<std::unique_ptr<can::Transport>> transports;
  std::vector<can::Transport*> pointers;
  for (std::size_t b = 0; b < file.buses.size(); ++b) {
    transports.push_back(
        can::OpenBus(file.buses[b], virtual_axes::Filters(file.axes, static_cast<int>(b))));
    pointers.push_back(transports.back().get());
  }
  virtual_axes::VirtualAxes axes(file.axes, plant, pointers);
  spdlog::info("{} axes, {} sensor nodes, {} body nodes on {} buses{}", file.axes.axes.size(),
               file.axes.nodes.size(), file.axes.body_nodes.size(), file.buses.size(),
               axes.held() ? "; held until all axes are driven" : "");
  std::optional<virtual_axes::SimulationTopics> simulation;
  if (topics.hand || topics.truth) simulation.emplace(options, topics, plant);
  node::BeginRealtime();
  axes.Start(types::MonotonicNow_ns());
  while (!stop.requested()) {
    const std::int64_t now_ns = types::MonotonicNow_ns();
    if (now_ns >= axes.next_ns()) {
      if (simulation) simulation->Exchange(axes, now_ns);
      const bool held = axes.held();
      axes.Run(now_ns);
      if (held && !axes.held()) spdlog::info("all axes are driven: let go");
    } else {
      can::WaitForAny(pointers, std::chrono::nanoseconds(axes.next_ns() - now_ns));
      axes.Answer(types::MonotonicNow_ns());
    }
  }
  spdlog::info("{} frames taken, {} steps", axes.frames_taken(), axes.steps());
  if (simulation && simulation->write_failures() > 0) {
    spdlog::warn("{} messages of the truth not written", simulation->write_failures());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> effects;
  virtual_axes::SimulationTopicsOptions topics;
  return node::RunParticipant(
      argc, argv, "virtual-axes", "Motor controllers and sensor nodes on a CAN bus, simulated",
      [&](const node::Options& options, node::StopFlag& stop) {
        Run(options, stop, effects, topics);
      },
      [&](CLI::App& app) {
        node::AddOption(app, "--effect", &effects,
                        "Undeclared effect of the surrogate, instead of the file's");
        node::AddFlag(app, "--hand", &topics.hand,
                      "Pushes and payloads: takes sim_disturbance and sim_body_disturbance from "
                      "the domain (experiments)");
        node::AddFlag(app, "--truth", &topics.truth,
                      "Writes sim_truth, and sim_body_truth of a robot on a floating base");
      });
}
