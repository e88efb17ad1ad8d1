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
#pragma once

#include <sinew_idl/joint.h>
#include <sinew_idl/simulation.h>

#include <cstdint>
#include <optional>

#include "bridge/virtual_axes/virtual_axes.h"
#include "components/robot/provider/simulated_plant.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/node.h"

namespace sinew::virtual_axes {

struct SimulationTopicsOptions {
  bool hand = false;
  bool truth = false;
};

class SimulationTopics {
 public:
  // The plant, which moves behind the axes, must outlive it. Throws DdsError.
  SimulationTopics(const node::Options& node_options, const SimulationTopicsOptions& options,
                   provider::SimulatedPlant& plant);

  // Applies arrived messages, and writes those that are due. Before each step of the axes.
  void Exchange(VirtualAxes& axes, std::int64_t now_ns);

  std::uint64_t write_failures() const { return write_failures_; }

 private:
  void PushLinks(VirtualAxes& axes, std::int64_t now_ns);
  void PushBody(std::int64_t now_ns);
  void WriteTruth(const msg::Header& of_state);
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

}  // namespace sinew::virtual_axes
