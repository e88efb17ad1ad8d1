// A mass on a link that a change of an arm's base parameters amounts to: what a refit absorbed, or
// what one recording has and another has not.
//
//     change = d beta / d phi_k * phi(m, c) + e,   e ~ N(0, information^-1)
//
// phi(m, c): a point mass m at c of link k (inertial.h). The link that leaves least is named. Of
// two links whose joint between them hardly moves either may be. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "components/bodies/dynamics/dynamics.h"

namespace sinew::arm {

struct LoadOnLink {
  std::string link;
  double mass_kg = 0.0;  // below 0: less than declared
  double half_width_95 = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // in the link's frame
  double share = 0.0;                                    // of the change's misfit that it explains
};

// change: of the base parameters; information: inverse of its covariance, may be singular. None:
// no single mass explains 95 % of the change, or its mass may as well be zero.
std::optional<LoadOnLink> FindLoad(const ArmDynamics& dynamics, const BaseParameters& base,
                                   const Eigen::VectorXd& change,
                                   const Eigen::MatrixXd& information);

}  // namespace sinew::arm
