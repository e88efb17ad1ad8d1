// sinew-recorded-reference: stands in for sinew-reference: a recording's reference at the running
// session's ticks, from rest where the robot stands. What is computed from it is marked as replay.
#include <sinew_idl/joint.h>

#include "components/robot/reference/participant/translate.h"
#include "components/robot/reference/standby.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"
#include "sim/stand_ins/participant/stands_in.h"
#include "sim/stand_ins/recorded_reference/file/recorded_file.h"

namespace {

using namespace sinew;

void Run(const node::Options& options, node::StopFlag& stop) {
  reference::Standby generator(stand_ins::LoadRecordedReference(options.config_path));

  node::Node node(stand_ins::StandsInFor("reference", options));
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  reference::OperatorStarts starts(node);
  auto output = node.MakeWriter(node::kReference);
  node::OtherOwner owner(node, node::kReference);
  while (auto tick = loop.Next()) {
    reference::RobotReferenceInput input = reference::ToInput(*tick, state.value());
    starts.AddTo(&input, state.value().header.origin, &loop);
    tick->origin = msg::Origin::kReplay;
    while (const auto other = owner.TakeNext(*tick)) {
      generator.Follow(other->header.tick, reference::FromMessage(*other));
    }
    const reference::RobotReferenceOutput now = generator.Step(input, owner.StandsBy(*tick));
    loop.Publish(output, reference::ToMessage(now, *tick), *tick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(argc, argv, "recorded-reference",
                                     "Stands in for sinew-reference: the reference of a recording.",
                                     Run);
}
