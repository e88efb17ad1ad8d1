#include "components/arm/arm_loop.h"

namespace sinew::arm {

ArmLoop FitArm(const Arm& arm, const actuator::RobotModel& robot,
               const identify::ProcessingOptions& wished, ArmRuns* train, ArmRuns* sealed) {
  ArmLoop loop;
  loop.processing = identify::Resolve(wished, train->front());
  loop.before = arm.Fit(*train, robot, loop.processing);
  loop.sealed_nominal = arm.ErrorOf(*sealed, robot, arm.dynamics().nominal(), loop.processing);
  loop.sealed_before = arm.ErrorOf(*sealed, loop.before.robot, loop.before.phi, loop.processing);
  arm.AddRigidTorque(loop.before.phi, loop.processing, robot, train);
  arm.AddRigidTorque(loop.before.phi, loop.processing, robot, sealed);
  return loop;
}

void FinishArm(const Arm& arm, const actuator::RobotModel& corrected, const ArmRuns& train,
               const ArmRuns& sealed, ArmLoop* loop) {
  loop->after = arm.Fit(train, corrected, loop->processing);
  loop->sealed_after = arm.ErrorOf(sealed, loop->after.robot, loop->after.phi, loop->processing);
}

}  // namespace sinew::arm
