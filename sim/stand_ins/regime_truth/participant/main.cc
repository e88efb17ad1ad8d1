// sinew-regime-truth: stands in for sinew-regime on a simulated robot: inside the backlash or
// outside as the simulation has it, from the first tick on.
#include <sinew_idl/regime.h>
#include <sinew_idl/simulation.h>

#include "components/base/config/config.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"
#include "sim/stand_ins/participant/stands_in.h"

namespace {

using namespace sinew;

msg::RegimeState ToRegime(const node::TickInput<msg::SimTruth>& input, std::uint64_t tick) {
  const msg::SimTruth& truth = input.value();
  msg::RegimeState message;
  message.state_tick = tick;
  message.stale = !input.fresh();
  message.joint_count = truth.joint_count;
  for (std::size_t j = 0; j < truth.joint_count; ++j) {
    // A gear without backlash has nothing to be inside of.
    const bool inside = truth.contact[j] == msg::ContactSide::kNone && truth.backlash_rad[j] > 0.0;
    const bool known = input.fresh();
    message.phase[j] = known ? msg::RegimePhase::kExecution : msg::RegimePhase::kWaiting;
    message.regime[j] = !known   ? msg::RegimeKind::kUnknown
                        : inside ? msg::RegimeKind::kSea
                                 : msg::RegimeKind::kPea;
    message.contact[j] = known ? truth.contact[j] : msg::ContactSide::kNone;
    message.play_angle_rad[j] = truth.play_angle_rad[j];
    message.backlash_rad[j] = truth.backlash_rad[j];
    message.confidence[j] = known ? 1.0 : 0.0;
  }
  return message;
}

void Run(const node::Options& options, node::StopFlag& stop) {
  if (!options.config_path.empty()) {
    throw UsageError("--config: the true regime has no configuration file, expected none");
  }
  node::Node node(stand_ins::StandsInFor("regime", options));
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto& truth = loop.AddInput(node::kSimTruth);
  auto output = node.MakeWriter(node::kRegime);
  node::OtherOwner owner(node, node::kRegime);
  while (const auto tick = loop.Next()) {
    owner.Watch(*tick);
    loop.Publish(output, ToRegime(truth, state.tick()), *tick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(
      argc, argv, "regime-truth",
      "Stands in for sinew-regime: the contact of a simulated robot's gears, as it is.", Run);
}
