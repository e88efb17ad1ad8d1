// sinew-reference: publishes `reference`, where the joints should be.
#include "components/robot/reference/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  return node::RunParticipant(argc, argv, "reference", "Where the joints should be.",
                              [](const node::Options& options, node::StopFlag& stop) {
                                reference::MakeReference(options, stop)->Run();
                              });
}
