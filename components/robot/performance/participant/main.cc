// sinew-performance: publishes `performance`: tracking errors and energies of the joints.
#include "components/robot/performance/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  return node::RunParticipant(argc, argv, "performance",
                              "How well the joints follow their references, and what it takes.",
                              [](const node::Options& options, node::StopFlag& stop) {
                                performance::MakePerformance(options, stop)->Run();
                              });
}
