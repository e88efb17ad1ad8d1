// sinew-virtual-axes: motor controllers and sensor nodes on buses, with the surrogate or a world
// behind them.
#include <sinew_idl/joint.h>
#include <sinew_idl/simulation.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>

#include "bridge/virtual_axes/file/virtual_axes_config.h"
#include "bridge/virtual_axes/virtual_axes.h"
#include "components/base/types/clock/clock.h"
#include "components/robot/provider/participant/simulation_messages.h"
#include "components/robot/provider/simulated_plant.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"
#include "components/topics/node/realtime.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"
#include "sim/world/file/world_file.h"

namespace sinew::virtual_axes {
namespace {

struct SimulationTopicsOptions {
  bool hand = false;
  bool truth = false;
};

constexpr std::int64_t kSilence_ns = 100'000'000;

// The topics of the simulation behind the axes, which a robot on a bus does not have: who pushes
// and loads it, and what no sensor measures. The bridge is the state provider and knows nothing of
// them.
//
//   hand    sim_disturbance acts on the links, sim_body_disturbance on the body of a robot on a
//           floating base; in the session that runs only. Both let go 100 ms after their last
//           message.
//   truth   sim_truth, and sim_body_truth of a robot on a floating base: once for each joint_state
//           that is received, with its session and tick, and the plant's state of that moment.
//           joint_state has what the buses had carried by then, some milliseconds older.
//
// Thread: the axes' loop; waits for nothing.
class SimulationTopics {
 public:
  // The plant, which moves behind the axes, must outlive it. Throws DdsError.
  SimulationTopics(const node::Options& node_options, const SimulationTopicsOptions& options,
                   provider::SimulatedPlant& plant)
      : plant_(plant), node_(node_options), states_(node_.MakeReader(node::kJointState)) {
    const bool floats = plant.body_truth() != nullptr;
    if (options.hand) {
      disturbance_.emplace(node_.MakeReader(node::kSimDisturbance));
      if (floats) body_disturbance_.emplace(node_.MakeReader(node::kSimBodyDisturbance));
    }
    if (options.truth) {
      truth_.emplace(node_.MakeWriter(node::kSimTruth));
      if (floats) body_truth_.emplace(node_.MakeWriter(node::kSimBodyTruth));
    }
  }

  // Applies arrived messages, and writes those that are due. Before each step of the axes.
  void Exchange(VirtualAxes& axes, std::int64_t now_ns) {
    const auto state = states_.TakeLatest();
    if (state) {
      const types::MessageHeader header = state->header;
      running_ = {header.session_id, header.origin};
    }
    if (disturbance_) PushLinks(axes, now_ns);
    if (body_disturbance_) PushBody(now_ns);
    if (state && truth_) WriteTruth(state->header);
  }

  std::uint64_t write_failures() const { return write_failures_; }

 private:
  void PushLinks(VirtualAxes& axes, std::int64_t now_ns) {
    const auto said = disturbance_->TakeLatest();
    if (said && gate_.Admits(types::CommandKind::kRequest, said->header, running_)) {
      pushed_ns_ = now_ns;
      for (int j = 0; j < std::min<int>(plant_.joint_count(), said->joint_count); ++j) {
        axes.SetHand(j, said->load_force_N[static_cast<std::size_t>(j)]);
      }
    } else if (now_ns - pushed_ns_ > kSilence_ns) {
      for (int j = 0; j < plant_.joint_count(); ++j) axes.SetHand(j, 0.0);
    }
  }
  void PushBody(std::int64_t now_ns) {
    while (const auto said = body_disturbance_->TakeNext()) {
      if (!body_gate_.Admits(types::CommandKind::kRequest, said->header, running_)) {
        continue;
      }
      const provider::BodyDisturbance disturbance = provider::FromMessage(*said);
      if (!provider::IsPossible(disturbance)) {
        body_gate_.Refuse("a value that is not finite, or a mass below 0");
        continue;
      }
      body_pushed_ns_ = now_ns;
      plant_.DisturbBody(disturbance);
    }
    if (body_pushed_ns_ != 0 && now_ns - body_pushed_ns_ > kSilence_ns) {
      body_pushed_ns_ = 0;
      plant_.DisturbBody({});
    }
  }
  void WriteTruth(const msg::Header& of_state) {
    msg::Header header = of_state;
    header.stamp_ns = types::EpochNow_ns();
    header.origin = msg::Origin::kSim;
    Count(truth_->Write(provider::ToMessage(header, plant_.joint_count(), plant_.gear_truth())));
    if (body_truth_) Count(body_truth_->Write(provider::ToMessage(header, *plant_.body_truth())));
  }
  void Count(node::WriteStatus status) {
    if (status != node::WriteStatus::kOk) ++write_failures_;
  }

  provider::SimulatedPlant& plant_;
  node::Node node_;
  node::Reader<msg::JointState> states_;
  std::optional<node::Reader<msg::SimDisturbance>> disturbance_;
  std::optional<node::Reader<msg::SimBodyDisturbance>> body_disturbance_;
  node::CommandGate gate_{"sim_disturbance"}, body_gate_{"sim_body_disturbance"};
  types::RunningSession running_;
  std::int64_t pushed_ns_ = 0, body_pushed_ns_ = 0;  // the last message
  std::optional<node::Writer<msg::SimTruth>> truth_;
  std::optional<node::Writer<msg::SimBodyTruth>> body_truth_;
  std::uint64_t write_failures_ = 0;
};

// The plant behind the axes: rigs side by side, or a world.
std::unique_ptr<provider::SimulatedPlant> MakePlant(const VirtualAxesFile& file,
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
         const std::vector<std::string>& effects, const SimulationTopicsOptions& topics) {
  if (options.config_path.empty()) {
    throw UsageError("--config: the axes are needed, e.g. robots/rig/virtual_axes.yaml");
  }
  auto file = config::Read<VirtualAxesFile>(config::Section::Load(options.config_path, kSchema));
  file.axes.seed = options.seed;
  const std::unique_ptr<provider::SimulatedPlant> simulated = MakePlant(file, options, effects);
  provider::SimulatedPlant& plant = *simulated;

  try {
    CheckVirtualAxesConfig(file.axes, plant.joint_count(), static_cast<int>(file.buses.size()));
  } catch (const std::invalid_argument& error) {
    throw UsageError(options.config_path.string() + ": " + error.what());
  }
  std::vector<std::unique_ptr<can::Transport>> transports;
  std::vector<can::Transport*> pointers;
  for (std::size_t b = 0; b < file.buses.size(); ++b) {
    transports.push_back(can::OpenBus(file.buses[b], Filters(file.axes, static_cast<int>(b))));
    pointers.push_back(transports.back().get());
  }
  VirtualAxes axes(file.axes, plant, pointers);
  spdlog::info("{} axes, {} sensor nodes, {} body nodes on {} buses{}", file.axes.axes.size(),
               file.axes.nodes.size(), file.axes.body_nodes.size(), file.buses.size(),
               axes.held() ? "; held until all axes are driven" : "");
  std::optional<SimulationTopics> simulation;
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
}  // namespace sinew::virtual_axes

int main(int argc, char** argv) {
  using namespace sinew;
  std::vector<std::string> effects;
  virtual_axes::SimulationTopicsOptions topics;
  return node::RunParticipant(
      argc, argv, "virtual-axes", "Motor controllers and sensor nodes on a CAN bus, simulated",
      [&](const node::Options& options, node::StopFlag& stop) {
        virtual_axes::Run(options, stop, effects, topics);
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
