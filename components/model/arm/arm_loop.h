// The whole path of `sinew close-loop` for an arm: rigid bodies and friction of all joints
// together, then each joint's own residual over the catalogue, then all together again with what
// was found. Pure; allocates; reads no clock. Throws std::invalid_argument for recordings that
// cannot be used.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "components/model/arm/arm_fit.h"

namespace sinew::arm {

// A mass on a link that a change of an arm's base parameters amounts to: what a refit absorbed, or
// what one recording has and another has not.
//
//     change = d beta / d phi_k * phi(m, c) + e,   e ~ N(0, information^-1)
//
// phi(m, c): a point mass m at c of link k (inertial.h). The link that leaves least is named. Of
// two links whose joint between them hardly moves either may be.
struct LoadOnLink {
  std::string link;
  double mass_kg = 0.0;  // below 0: less than declared
  double half_width_95 = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // in the link's frame
  double share = 0.0;                                    // of the change's misfit that it explains
};

struct ArmLoop {
  identify::ProcessingOptions processing;  // of all joints
  ArmFit before;                           // declared friction
  ArmFit after;                            // with the effects that were found
  ArmError held_out_nominal, held_out_before, held_out_after;
  std::optional<LoadOnLink> load, held_out_load;  // AbsorbedLoad, LoadHeldOut
};

// First half: the joint fit; train and held-out get the rigid torque of each joint, and the model
// that comes back has the fitted friction. Cut-offs that `wished` leaves to the data are those of
// the first joint.
ArmLoop FitArm(const Arm& arm, const actuator::RobotModel& robot,
               const identify::ProcessingOptions& wished, ArmRuns* train, ArmRuns* held_out);

// The mass that the refit of the bodies absorbed.
std::optional<LoadOnLink> AbsorbedLoad(const Arm& arm, const ArmFit& fit);

// The mass that the held-out recordings have beside those of loop.before; robot as declared. None
// as well where they are too short for a fit of their own.
std::optional<LoadOnLink> LoadHeldOut(const Arm& arm, const actuator::RobotModel& robot,
                                      const ArmLoop& loop, const ArmRuns& held_out);

// Mean of the squares of errors on recordings, each weighted by its rows. Throws
// std::invalid_argument unless there is a weight for each.
ArmError Pooled(const std::vector<ArmError>& errors, const std::vector<double>& rows);

// Error of all joints fitted together to train, on the held-out recordings: mean of rms over twice
// the effort limit, per cent; relative without limits.
double HeldOutError(const Arm& arm, const actuator::RobotModel& robot, const ArmRuns& train,
                    const ArmRuns& held_out, const identify::ProcessingOptions& processing);

// Second half: corrected holds what tracing each joint found.
void FinishArm(const Arm& arm, const actuator::RobotModel& corrected, const ArmRuns& train,
               const ArmRuns& held_out, ArmLoop* loop);

}  // namespace sinew::arm
