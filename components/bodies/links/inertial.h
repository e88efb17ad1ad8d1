// The ten inertial parameters of a rigid body about a point, in the axes of a frame:
//
//     phi = m, m c (3), Ixx, Ixy, Ixz, Iyy, Iyz, Izz        (c from the point, I about the point)
//
// kg, kg m, kg m^2. Khalil, Dombre: Modeling, Identification and Control of Robots (2002), 9.3.
// Thread: free functions. Allocates nothing, throws nothing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sinew::arm {

inline constexpr int kParametersPerBody = 10;
using Inertial = Eigen::Matrix<double, kParametersPerBody, 1>;

// Cross(x) y = x x y
inline Eigen::Matrix3d Cross(const Eigen::Vector3d& x) noexcept {
  Eigen::Matrix3d out;
  out << 0.0, -x.z(), x.y(), x.z(), 0.0, -x.x(), -x.y(), x.x(), 0.0;
  return out;
}

// I of phi.
inline Eigen::Matrix3d InertiaOf(const Inertial& phi) noexcept {
  Eigen::Matrix3d out;
  out << phi[4], phi[5], phi[6], phi[5], phi[7], phi[8], phi[6], phi[8], phi[9];
  return out;
}

// About the origin of a frame in which the body's own frame is `frame`. com_m: in the body's frame;
// inertia_kg_m2: about the centre of mass, in the body's axes.
inline Inertial InertialIn(const Eigen::Isometry3d& frame, double mass_kg,
                           const Eigen::Vector3d& com_m,
                           const Eigen::Matrix3d& inertia_kg_m2) noexcept {
  const Eigen::Matrix3d& R = frame.linear();
  const Eigen::Vector3d com = frame * com_m;
  const Eigen::Matrix3d c = Cross(com);
  const Eigen::Matrix3d I = R * inertia_kg_m2 * R.transpose() - mass_kg * c * c;
  Inertial phi;
  phi << mass_kg, mass_kg * com, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2);
  return phi;
}

}  // namespace sinew::arm
