#include "components/model/arm/arm_loop.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace sinew::arm {

ArmLoop FitArm(const Arm& arm, const actuator::RobotModel& robot,
               const identify::ProcessingOptions& wished, ArmRuns* train, ArmRuns* held_out) {
  ArmLoop loop;
  loop.processing = identify::Resolve(wished, train->front());
  loop.before = arm.Fit(*train, robot, loop.processing);
  loop.held_out_nominal = arm.ErrorOf(*held_out, robot, arm.dynamics().nominal(), loop.processing);
  loop.held_out_before =
      arm.ErrorOf(*held_out, loop.before.robot, loop.before.phi, loop.processing);
  const Eigen::VectorXd inertia = arm.Inertia(loop.before.phi, *train, robot, loop.processing);
  std::vector<identify::ProcessingOptions> of_joint;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    for (types::Run& run : train->at(j)) {
      run.rigid_inertia = inertia[static_cast<Eigen::Index>(j)];
    }
    of_joint.push_back(identify::FromMotion(train->at(j), robot.joints[j], wished.longest_gap_s));
  }
  arm.AddRigidTorque(loop.before, of_joint, robot, train);
  arm.AddRigidTorque(loop.before, of_joint, robot, held_out);
  return loop;
}

std::optional<LoadOnLink> AbsorbedLoad(const Arm& arm, const ArmFit& fit) {
  return FindLoad(arm.dynamics(), arm.base(),
                  arm.base().Of(fit.phi) - arm.base().Of(arm.dynamics().nominal()),
                  fit.information);
}

std::optional<LoadOnLink> LoadHeldOut(const Arm& arm, const actuator::RobotModel& robot,
                                      const ArmLoop& loop, const ArmRuns& held_out) {
  try {
    const ArmFit there = arm.Fit(held_out, robot, loop.processing);
    const Eigen::MatrixXd both = loop.before.information + there.information;
    // The covariances of both add up.
    return FindLoad(
        arm.dynamics(), arm.base(), arm.base().Of(there.phi) - arm.base().Of(loop.before.phi),
        loop.before.information * both.completeOrthogonalDecomposition().solve(there.information));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

ArmError Pooled(const std::vector<ArmError>& errors, const std::vector<double>& rows) {
  if (errors.empty() || errors.size() != rows.size()) {
    throw std::invalid_argument("errors of " + std::to_string(errors.size()) +
                                " recordings, expected as many as weights (" +
                                std::to_string(rows.size()) + "), one at least");
  }
  const double all = std::accumulate(rows.begin(), rows.end(), 0.0);
  const auto mean = [&](const auto& of) {
    double squares = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      squares += rows[i] / all * std::pow(of(errors[i]), 2);
    }
    return std::sqrt(squares);
  };
  ArmError out = errors.front();
  out.all_relative_percent = mean([](const ArmError& e) { return e.all_relative_percent; });
  out.nrms_percent = mean([](const ArmError& e) { return e.nrms_percent; });
  for (std::size_t j = 0; j < out.rms_Nm.size(); ++j) {
    out.rms_Nm[j] = mean([j](const ArmError& e) { return e.rms_Nm[j]; });
    out.relative_percent[j] = mean([j](const ArmError& e) { return e.relative_percent[j]; });
  }
  return out;
}

double HeldOutError(const Arm& arm, const actuator::RobotModel& robot, const ArmRuns& train,
                    const ArmRuns& held_out, const identify::ProcessingOptions& processing) {
  const ArmFit fit = arm.Fit(train, robot, processing);
  const ArmError error = arm.ErrorOf(held_out, fit.robot, fit.phi, processing);
  return error.nrms_percent > 0.0 ? error.nrms_percent : error.all_relative_percent;
}

void FinishArm(const Arm& arm, const actuator::RobotModel& corrected, const ArmRuns& train,
               const ArmRuns& held_out, ArmLoop* loop) {
  loop->after = arm.Fit(train, corrected, loop->processing);
  loop->held_out_after =
      arm.ErrorOf(held_out, loop->after.robot, loop->after.phi, loop->processing);
}

}  // namespace sinew::arm
