// sinew-body-disturbance: loads and pushes the body of a simulated robot, as a file says. It
// publishes sim_body_disturbance in every tick, so that in lockstep a provider can await it.
#include <sinew_idl/joint.h>
#include <sinew_idl/simulation.h>
#include <spdlog/spdlog.h>

#include <optional>

#include "components/base/types/robot_state.h"
#include "components/topics/node/node.h"
#include "components/topics/node/tick_loop.h"
#include "sim/body_disturbance/file/schedule_file.h"

namespace {

using namespace sinew;

msg::SimBodyDisturbance ToMessage(const provider::BodyDisturbance& disturbance) {
  msg::SimBodyDisturbance message;
  message.payload_link = disturbance.payload_link;
  message.payload_kg = disturbance.payload_kg;
  message.payload_m = disturbance.payload_m;
  message.push_link = disturbance.push_link;
  message.push_force_N = disturbance.push_force_N;
  message.push_m = disturbance.push_m;
  message.lost_drive = disturbance.lost_drive;
  message.lost_friction = disturbance.lost_friction;
  return message;
}

void Log(std::uint64_t tick, const provider::BodyDisturbance& now) {
  const auto& f = now.push_force_N;
  spdlog::info(
      "tick {}: payload {} kg on '{}', push {} {} {} N on '{}', lost drive '{}', "
      "lost friction {}",
      tick, now.payload_kg, now.payload_link, f[0], f[1], f[2], now.push_link, now.lost_drive,
      now.lost_friction);
}

void Run(const node::Options& options, node::StopFlag& stop) {
  const body_disturbance::Schedule schedule = body_disturbance::LoadSchedule(options.config_path);

  node::Node node(options);
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto output = node.MakeWriter(node::kSimBodyDisturbance);
  std::optional<std::uint64_t> armed_tick;
  provider::BodyDisturbance acting;
  while (const auto tick = loop.Next()) {
    if (state.value().header.origin == msg::Origin::kLive) {
      throw UsageError("the robot is hardware, expected a simulated one: nobody pushes it by DDS");
    }
    if (!armed_tick && types::MayMove(state.value().robot_state)) {
      armed_tick = tick->tick;
    }
    provider::BodyDisturbance now;
    if (armed_tick) now = schedule.At(tick->tick - *armed_tick, tick->nominal_period_s);
    if (now != acting) Log(tick->tick, now);
    acting = now;
    loop.Publish(output, ToMessage(now), *tick);
  }
  if (!state.has_value()) return;
  msg::SimBodyDisturbance nothing;  // whoever ends this program takes load and hand away
  nothing.header = state.value().header;
  (void)output.Write(nothing);
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(
      argc, argv, "body-disturbance",
      "Loads and pushes the body of a simulated robot on a floating base, takes drives and "
      "friction away, as a file says.",
      Run);
}
