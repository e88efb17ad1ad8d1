// sinew-regime: publishes `regime`, inside the backlash or outside; asks for motion in its setup
// phase.
#include "components/robot/regime/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  return node::RunParticipant(argc, argv, "regime",
                              "Inside the backlash (SEA) or outside (PEA), Fig 7.1.",
                              [](const node::Options& options, node::StopFlag& stop) {
                                regime::MakeRegime(options, stop)->Run();
                              });
}
