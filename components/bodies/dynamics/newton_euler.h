// One step of the recursive Newton-Euler algorithm, from a link to the next and of one body:
//
//     f = m a + dw x (m c) + w x (w x (m c)),   n = (m c) x a + I dw + w x (I w)
//
// with a the acceleration of the link's origin less gravity, w and dw the angular velocity and
// acceleration, n about the origin, all in the link's axes (Khalil, Dombre: Modeling,
// Identification and Control of Robots (2002), 9.3; Featherstone: Rigid Body Dynamics Algorithms,
// 5.3). rad, Nm; a prismatic joint m, N. Thread: free functions. Allocates nothing, throws nothing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "components/bodies/links/inertial.h"
#include "components/bodies/links/links.h"

namespace sinew::arm {

struct LinkMotion {
  Eigen::Matrix3d parent_from_link = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin_in_parent = Eigen::Vector3d::Zero();
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  Eigen::Vector3d dw = Eigen::Vector3d::Zero();
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
};

// Force on a body and its moment about the link's origin.
struct LinkWrench {
  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
};

// The same, linear in phi: f = F phi, n = N phi.
struct WrenchColumns {
  Eigen::Matrix<double, 3, kParametersPerBody> f, n;
};

// Motion of a link on a parent that moves so, with its joint's position, velocity and acceleration.
inline LinkMotion Outward(const MovingLink& link, const LinkMotion& parent, double q, double v,
                          double a) noexcept {
  Eigen::Isometry3d in_parent = link.parent_from_joint;
  if (link.prismatic) {
    in_parent.translate(q * link.axis);
  } else {
    in_parent.rotate(Eigen::AngleAxisd(q, link.axis));
  }
  LinkMotion here;
  here.parent_from_link = in_parent.linear();
  here.origin_in_parent = in_parent.translation();
  const Eigen::Matrix3d back = here.parent_from_link.transpose();
  const Eigen::Vector3d& p = here.origin_in_parent;
  const Eigen::Vector3d w = back * parent.w;
  here.w = w;
  here.dw = back * parent.dw;
  here.a = back * (parent.a + parent.dw.cross(p) + parent.w.cross(parent.w.cross(p)));
  if (link.prismatic) {
    here.a += a * link.axis + 2.0 * w.cross(v * link.axis);
  } else {
    here.w += v * link.axis;
    here.dw += a * link.axis + w.cross(v * link.axis);
  }
  return here;
}

inline LinkWrench WrenchOf(const LinkMotion& m, const Inertial& phi) noexcept {
  const Eigen::Vector3d moment = phi.segment<3>(1);
  const Eigen::Matrix3d inertia = InertiaOf(phi);
  return {phi[0] * m.a + m.dw.cross(moment) + m.w.cross(m.w.cross(moment)),
          moment.cross(m.a) + inertia * m.dw + m.w.cross(inertia * m.w)};
}

// I x = DotColumns(x) (Ixx, Ixy, Ixz, Iyy, Iyz, Izz)
inline Eigen::Matrix<double, 3, 6> DotColumns(const Eigen::Vector3d& x) noexcept {
  Eigen::Matrix<double, 3, 6> out;
  out << x.x(), x.y(), x.z(), 0.0, 0.0, 0.0,  //
      0.0, x.x(), 0.0, x.y(), x.z(), 0.0,     //
      0.0, 0.0, x.x(), 0.0, x.y(), x.z();
  return out;
}

inline WrenchColumns ColumnsOf(const LinkMotion& m) noexcept {
  WrenchColumns out;
  out.f.setZero();
  out.n.setZero();
  out.f.col(0) = m.a;
  out.f.block<3, 3>(0, 1) = Cross(m.dw) + Cross(m.w) * Cross(m.w);
  out.n.block<3, 3>(0, 1) = -Cross(m.a);
  out.n.block<3, 6>(0, 4) = DotColumns(m.dw) + Cross(m.w) * DotColumns(m.w);
  return out;
}

// A wrench, or its columns, about the parent's origin in the parent's axes.
template <class Wrench>
Wrench Inward(const LinkMotion& link, const Wrench& wrench) noexcept {
  Wrench out;
  out.f = link.parent_from_link * wrench.f;
  out.n = link.parent_from_link * wrench.n + Cross(link.origin_in_parent) * out.f;
  return out;
}

}  // namespace sinew::arm
