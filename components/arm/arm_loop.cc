#include "components/arm/arm_loop.h"

namespace sinew::arm {

ArmLoop FitArm(const Arm& arm, const actuator::RobotModel& robot,
               const identify::ProcessingOptions& wished, ArmRuns* train, ArmRuns* sealed) {
  ArmLoop loop;
  loop.processing = identify::Resolve(wished, train->front());
  loop.before = arm.Fit(*train, robot, loop.processing);
  loop.sealed_nominal = arm.ErrorOf(*sealed, robot, arm.dynamics().nominal(), loop.processing);
  loop.sealed_before = arm.ErrorOf(*sealed, loop.before.robot, loop.before.phi, loop.processing);
  const Eigen::VectorXd inertia = arm.Inertia(loop.before.phi, *train, robot, loop.processing);
  std::vector<identify::ProcessingOptions> of_joint;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    for (identify::Run& run : train->at(j)) {
      run.rigid_inertia = inertia[static_cast<Eigen::Index>(j)];
    }
    of_joint.push_back(identify::FromMotion(train->at(j), robot.joints[j], wished.longest_gap_s));
  }
  arm.AddRigidTorque(loop.before, of_joint, robot, train);
  arm.AddRigidTorque(loop.before, of_joint, robot, sealed);
  return loop;
}

double HeldOutError(const Arm& arm, const actuator::RobotModel& robot, const ArmRuns& train,
                    const ArmRuns& sealed, const identify::ProcessingOptions& processing) {
  const ArmFit fit = arm.Fit(train, robot, processing);
  const ArmError error = arm.ErrorOf(sealed, fit.robot, fit.phi, processing);
  return error.nrms_percent > 0.0 ? error.nrms_percent : error.all_relative_percent;
}

void FinishArm(const Arm& arm, const actuator::RobotModel& corrected, const ArmRuns& train,
               const ArmRuns& sealed, ArmLoop* loop) {
  loop->after = arm.Fit(train, corrected, loop->processing);
  loop->sealed_after = arm.ErrorOf(sealed, loop->after.robot, loop->after.phi, loop->processing);
}

}  // namespace sinew::arm
