// sinew-virtual-axes: motor controllers and sensor nodes on a bus, with the surrogate behind them.
#include <sinew_idl/joint.h>
#include <sinew_idl/simulation.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>

#include "bridge/virtual_axes/file/virtual_axes_config.h"
#include "bridge/virtual_axes/virtual_axes.h"
#include "components/node/command_gate.h"
#include "components/node/node.h"
#include "components/node/options.h"
#include "components/node/realtime.h"
#include "components/types/clock/clock.h"
#include "components/wire/wire.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"
#include "sim/world/file/world_file.h"

namespace {

using namespace sinew;

// The person at the link: pushes with the force of sim_disturbance, a topic that a robot on a bus
// does not read, in the session that runs, and lets go when no message arrives any more.
class Hand {
 public:
  explicit Hand(const node::Options& options)
      : node_(options),
        states_(node_.MakeReader(node::kJointState)),
        reader_(node_.MakeReader(node::kSimDisturbance)) {}

  void Push(virtual_axes::VirtualAxes& axes, int joints, std::int64_t now_ns) {
    if (const auto state = states_.TakeLatest()) {
      const types::MessageHeader header = wire::FromWire(state->header());
      running_ = {header.session_id, header.origin};
    }
    const auto said = reader_.TakeLatest();
    if (said &&
        gate_.Admits(types::CommandKind::kRequest, wire::FromWire(said->header()), running_)) {
      received_ns_ = now_ns;
      for (int j = 0; j < std::min<int>(joints, said->joint_count()); ++j) {
        axes.SetHand(j, said->load_force_N()[static_cast<std::size_t>(j)]);
      }
    } else if (now_ns - received_ns_ > kSilence_ns) {
      for (int j = 0; j < joints; ++j) axes.SetHand(j, 0.0);
    }
  }

 private:
  static constexpr std::int64_t kSilence_ns = 100'000'000;
  node::Node node_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::SimDisturbance> reader_;
  node::CommandGate gate_{"sim_disturbance"};
  types::RunningSession running_;
  std::int64_t received_ns_ = 0;
};

// What moves behind the axes: rigs side by side, or a world.
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
         const std::vector<std::string>& effects, bool with_hand) {
  if (options.config_path.empty()) {
    throw UsageError("--config: the axes are needed, e.g. robots/rig/virtual_axes.yaml");
  }
  const config::Section section =
      config::Section::Load(options.config_path, "sinew-virtual-axes/1");
  const virtual_axes::VirtualAxesFile file = virtual_axes::ReadVirtualAxes(section);
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
  spdlog::info("{} axes, {} sensor nodes on {} buses", file.axes.axes.size(),
               file.axes.nodes.size(), file.buses.size());
  std::optional<Hand> hand;
  if (with_hand) hand.emplace(options);
  node::BeginRealtime();
  axes.Start(types::MonotonicNow_ns());
  while (!stop.requested()) {
    const std::int64_t now_ns = types::MonotonicNow_ns();
    if (now_ns >= axes.next_ns()) {
      if (hand) hand->Push(axes, plant.joint_count(), now_ns);
      axes.Run(now_ns);
    } else {
      can::WaitForAny(pointers, std::chrono::nanoseconds(axes.next_ns() - now_ns));
      axes.Answer(types::MonotonicNow_ns());
    }
  }
  spdlog::info("{} frames taken, {} steps", axes.frames_taken(), axes.steps());
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> effects;
  bool with_hand = false;
  return node::RunParticipant(
      argc, argv, "virtual-axes", "Motor controllers and sensor nodes on a CAN bus, simulated",
      [&](const node::Options& options, node::StopFlag& stop) {
        Run(options, stop, effects, with_hand);
      },
      [&](CLI::App& app) {
        node::AddOption(app, "--effect", &effects,
                        "Undeclared effect of the surrogate, instead of the file's");
        node::AddFlag(app, "--hand", &with_hand,
                      "A person at the link: takes sim_disturbance from the domain (experiments)");
      });
}
