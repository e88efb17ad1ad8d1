// Rigid bodies and friction of all joints of an arm fitted together.
//
// For every joint j and sample: T_j + friction_j = Y_j(q, v, a) phi, with T_j the measured torque
// at the joint (drive_torque) and friction the terms of the joint's model. The unknowns are the
// changes of the base parameters against the URDF and every free linear parameter of the joints'
// terms; rows are weighted by 1 / (residual rms of their joint), found in a first pass (Gautier:
// Dynamic identification of robots with power model (1997); Khalil, Dombre (2002), ch. 12). Both
// sides go through the same filter as everywhere (identify/design.h); each joint counts where it
// moves. Pure; allocates; throws std::invalid_argument for recordings that do not fit together.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/bodies/dynamics/dynamics.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/identify/processing.h"

namespace sinew::arm {

// Recordings of all joints: runs[j] are those of joint j, in the same order for every joint.
using ArmRuns = std::vector<std::vector<types::Run>>;

struct BaseParameter {
  std::string name;  // of the independent parameter it is grouped to
  double nominal = 0.0;
  double value = 0.0;
  double half_width_95 = 0.0;
};

// Error against the measured torques, all rows of moving joints.
struct ArmError {
  std::vector<double> rms_Nm;            // per joint
  std::vector<double> relative_percent;  // per joint, 100 |residual| / |torque|
  double all_relative_percent = 0.0;     // the same over all joints
  // Mean of rms over twice the effort limit, as published for FloBaRoID; 0 without limits.
  double nrms_percent = 0.0;
};

// Estimate of the base parameters from the torques of all joints but one, against the fit of all:
// along each direction (base parameters x directions) their change is normal. A joint's own effects
// compete with a refit of the bodies under this prior.
struct RigidPrior {
  Eigen::MatrixXd directions;
  Eigen::VectorXd mean, spread;  // spread 0: nothing
};

struct ArmFit {
  actuator::RobotModel robot;  // friction as fitted
  Eigen::VectorXd phi;         // inertial parameters that give the fitted base parameters
  std::vector<BaseParameter> base;
  // Inverse of the covariance of the base parameters, friction fitted beside them.
  Eigen::MatrixXd information;
  std::vector<RigidPrior> by_others;  // per joint
  ArmError train;
};

// Joints of the model and joints of the dynamics by name; effort limits from the chain.
class Arm {
 public:
  // Throws std::invalid_argument when a joint of the one is missing in the other.
  Arm(const Chain& chain, const actuator::RobotModel& robot);

  const ArmDynamics& dynamics() const { return dynamics_; }
  const BaseParameters& base() const { return base_; }

  ArmFit Fit(const ArmRuns& runs, const actuator::RobotModel& robot,
             const identify::ProcessingOptions& processing) const;
  ArmError ErrorOf(const ArmRuns& runs, const actuator::RobotModel& robot,
                   const Eigen::VectorXd& phi, const identify::ProcessingOptions& processing) const;

  // Inertia of the bodies about each joint of the model with the others at rest, kg m^2 or kg, rms
  // over the first recordings.
  Eigen::VectorXd Inertia(const Eigen::VectorXd& phi, const ArmRuns& runs,
                          const actuator::RobotModel& robot,
                          const identify::ProcessingOptions& processing) const;

  // Writes into every run what the rigid bodies need of its joint (Run::rigid_torque), so that the
  // term `rigid_body` of a joint's model knows it, and how a refit of them changes it
  // (Run::rigid_columns). processing: of each joint, as used for its own balance.
  void AddRigidTorque(const ArmFit& fit, const std::vector<identify::ProcessingOptions>& processing,
                      const actuator::RobotModel& robot, ArmRuns* runs) const;

 private:
  struct Joint;
  std::vector<Joint> Prepare(const ArmRuns& runs, const actuator::RobotModel& robot,
                             const identify::ProcessingOptions& processing) const;
  std::vector<identify::StateSet> States(
      const ArmRuns& runs, const actuator::RobotModel& robot,
      const std::vector<identify::ProcessingOptions>& processing) const;
  // States of all joints at one sample, in the order of the dynamics.
  void StateAt(const std::vector<identify::StateSet>& states, std::size_t segment, Eigen::Index i,
               Eigen::VectorXd* q, Eigen::VectorXd* v, Eigen::VectorXd* a) const;
  // Regressors of every sample, [joint][segment], samples x parameters.
  std::vector<std::vector<Eigen::MatrixXd>> Regressors(
      const std::vector<identify::StateSet>& states) const;

  ArmDynamics dynamics_;
  BaseParameters base_;
  std::vector<int> row_;  // of the dynamics, for each joint of the model
  std::vector<double> effort_;
};

}  // namespace sinew::arm
