// A reference of our own: stay where the robot was at the first tick.
#include <sinew_idl/joint.h>
#include <sinew_idl/reference.h>

#include "components/model/effects/effect.h"
#include "components/topics/node/tick_loop.h"

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(
      argc, argv, "hold_still", "Holds the position of the first tick",
      [](const sinew::node::Options& options, sinew::node::StopFlag& stop) {
        sinew::node::Node node(options);
        sinew::node::TickLoop loop(node, stop);
        auto& state = loop.AddInput(sinew::node::kJointState);
        auto output = node.MakeWriter(sinew::node::kReference);
        sinew::msg::Reference reference;
        reference.joint_count = 0;
        while (const auto tick = loop.Next()) {
          if (reference.joint_count == 0) {
            reference.joint_count = state.value().joint_count;
            reference.position_rad = state.value().position_rad;
          }
          reference.state_tick = state.tick();
          loop.Publish(output, reference, *tick);
        }
      });
}
