// sinew-pneumatics: publishes `valve_command` and `pneumatic_state`: holds pressures or
// stiffnesses.
#include "components/robot/pneumatics/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  return node::RunParticipant(argc, argv, "pneumatics",
                              "Holds the pressure or stiffness of the pneumatic elements.",
                              [](const node::Options& options, node::StopFlag& stop) {
                                pneumatics::MakePneumatics(options, stop)->Run();
                              });
}
