// sinew-ideal-pressure: stands in for sinew-pneumatics on a simulated robot. The chambers have the
// pressure that is asked for, at once; the relays stay off.
#include <sinew_idl/simulation.h>

#include <vector>

#include "components/robot/pneumatics/participant/requests.h"
#include "components/topics/node/node.h"
#include "components/topics/node/tick_loop.h"
#include "sim/stand_ins/participant/stands_in.h"

namespace {

using namespace sinew;

struct Outputs {
  msg::SimPressure pressure;
  msg::ValveCommand relays;  // all off
  msg::PneumaticState state;
};

Outputs MakeOutputs(const pneumatics::PneumaticsConfig& config,
                    const std::vector<pneumatics::PressureManager>& targets, bool holds,
                    std::uint64_t tick) {
  Outputs out;
  const auto joints = static_cast<std::uint8_t>(targets.size());
  out.pressure.joint_count = joints;
  out.relays.joint_count = joints;
  out.state.joint_count = joints;
  out.state.state_tick = tick;
  for (std::size_t j = 0; j < targets.size(); ++j) {
    const double target_bar = targets[j].target_bar();
    out.pressure.imposed[j] = holds;
    out.pressure.chamber_pressure_bar[j] = target_bar;
    out.state.mode[j] = holds ? msg::PneumaticMode::kHold : msg::PneumaticMode::kIdle;
    out.state.target_pressure_bar[j] = target_bar;
    out.state.pressure_bar[j] = holds ? target_bar : 0.0;
    out.state.stiffness_Nm_rad[j] = config.joints[j].stiffness.Stiffness_Nm_rad(target_bar);
    out.state.settled[j] = holds;
  }
  return out;
}

void Run(const node::Options& options, node::StopFlag& stop) {
  const pneumatics::PneumaticsConfig config = pneumatics::LoadPneumatics(options.config_path);
  // Only their targets are used: the requests that they take and limit.
  std::vector<pneumatics::PressureManager> targets(config.joints.begin(), config.joints.end());

  node::Node node(stand_ins::StandsInFor("pneumatics", options));
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  pneumatics::PressureRequests requests(node, loop, config);
  auto pressure = node.MakeWriter(node::kSimPressure);
  auto relays = node.MakeWriter(node::kValveCommand);
  auto report = node.MakeWriter(node::kPneumaticState);
  while (const auto tick = loop.Next()) {
    if (state.value().header.origin == msg::Origin::kLive) {
      throw UsageError("the robot is hardware, expected a simulated one: air has no ideal source");
    }
    requests.Take(*tick, state.value().header.origin, &targets);
    // As a standby it imposes nothing: the owner's relays act.
    const bool holds = !requests.standby() && requests.MayHold(state.value().robot_state);
    const Outputs out = MakeOutputs(config, targets, holds, tick->tick);
    loop.Publish(pressure, out.pressure, *tick);
    loop.Publish(relays, out.relays, *tick);
    loop.Publish(report, out.state, *tick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(
      argc, argv, "ideal-pressure",
      "Stands in for sinew-pneumatics: the pressure that is asked for, in simulated chambers.",
      Run);
}
