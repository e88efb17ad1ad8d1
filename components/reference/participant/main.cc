// sinew-reference: publishes `reference`, where the joints should be.
#include <spdlog/spdlog.h>

#include "components/node/options.h"
#include "components/node/tick_loop.h"
#include "components/reference/file/reference_file.h"
#include "components/reference/participant/translate.h"
#include "components/wire/wire.h"

namespace {

void Run(const sinew::node::Options& options, sinew::node::StopFlag& stop) {
  using namespace sinew;
  if (options.config_path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-reference/1");
  }
  const reference::LoadedReference loaded = reference::LoadReference(options.config_path);
  for (const std::string& note : loaded.notes) spdlog::info("{}", note);
  reference::RobotReference generator(loaded.config);

  node::Node node(options);
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  reference::OperatorStarts starts(node);
  auto output = node.MakeWriter(node::kReference);
  while (const auto tick = loop.Next()) {
    reference::RobotReferenceInput input = reference::ToInput(*tick, state.value());
    starts.AddTo(&input, wire::FromWire(state.value().header().origin()));
    loop.Publish(output, reference::ToMessage(generator.Step(input), *tick), *tick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(argc, argv, "reference", "Where the joints should be.", Run);
}
