#include "components/arm/dynamics.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <random>
#include <stdexcept>

namespace sinew::arm {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Inertial = Eigen::Matrix<double, kParametersPerBody, 1>;

Matrix3d Cross(const Vector3d& x) {
  Matrix3d out;
  out << 0.0, -x.z(), x.y(), x.z(), 0.0, -x.x(), -x.y(), x.x(), 0.0;
  return out;
}

Matrix3d InertiaOf(const Inertial& phi) {
  Matrix3d out;
  out << phi[4], phi[5], phi[6], phi[5], phi[7], phi[8], phi[6], phi[8], phi[9];
  return out;
}

Inertial Pack(double mass, const Vector3d& moment, const Matrix3d& inertia) {
  Inertial phi;
  phi << mass, moment, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1), inertia(1, 2),
      inertia(2, 2);
  return phi;
}

// Parameters of a body about the origin of another frame, in which the body's frame is `frame`.
Inertial Moved(const Body& body, const Eigen::Isometry3d& frame) {
  const Matrix3d& R = frame.linear();
  const Vector3d com = frame * body.com_m;
  const Matrix3d c = Cross(com);
  return Pack(body.mass_kg, body.mass_kg * com,
              R * body.inertia_kg_m2 * R.transpose() - body.mass_kg * c * c);
}

// I x = Dot(x) (Ixx, Ixy, Ixz, Iyy, Iyz, Izz)
Eigen::Matrix<double, 3, 6> Dot(const Vector3d& x) {
  Eigen::Matrix<double, 3, 6> out;
  out << x.x(), x.y(), x.z(), 0.0, 0.0, 0.0,  //
      0.0, x.x(), 0.0, x.y(), x.z(), 0.0,     //
      0.0, 0.0, x.x(), 0.0, x.y(), x.z();
  return out;
}

}  // namespace

ArmDynamics::ArmDynamics(const Chain& chain, const Vector3d& gravity_m_s2)
    : gravity_(gravity_m_s2) {
  // For every body the moving link that carries it (-1: the base) and its frame there.
  std::vector<int> carrier(chain.bodies.size(), -1);
  std::vector<Eigen::Isometry3d> frame(chain.bodies.size(), Eigen::Isometry3d::Identity());
  std::vector<Inertial> phi;
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    const Body& body = chain.bodies[i];
    const int parent = body.parent < 0 ? -1 : carrier[static_cast<std::size_t>(body.parent)];
    const Eigen::Isometry3d in_parent =
        body.parent < 0 ? body.parent_from_joint
                        : frame[static_cast<std::size_t>(body.parent)] * body.parent_from_joint;
    if (body.moves) {
      carrier[i] = static_cast<int>(links_.size());
      links_.push_back({parent, body.prismatic, in_parent, body.axis.normalized()});
      joint_names_.push_back(body.joint_name);
      phi.push_back(Moved(body, Eigen::Isometry3d::Identity()));
      for (const char* name : {"m", "mx", "my", "mz", "Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz"}) {
        parameter_names_.push_back(body.link_name + "." + name);
      }
      continue;
    }
    carrier[i] = parent;
    frame[i] = in_parent;
    if (parent >= 0) phi[static_cast<std::size_t>(parent)] += Moved(body, in_parent);
  }
  if (links_.empty()) {
    throw std::invalid_argument("robot '" + chain.name + "' has no moving joint");
  }
  nominal_.resize(parameters());
  for (int i = 0; i < joints(); ++i) {
    nominal_.segment<kParametersPerBody>(kParametersPerBody * i) = phi[static_cast<std::size_t>(i)];
  }
}

std::vector<ArmDynamics::Motion> ArmDynamics::Forward(
    const Eigen::Ref<const Eigen::VectorXd>& q, const Eigen::Ref<const Eigen::VectorXd>& v,
    const Eigen::Ref<const Eigen::VectorXd>& a) const {
  std::vector<Motion> motions(links_.size());
  const Vector3d zero = Vector3d::Zero();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const auto k = static_cast<Eigen::Index>(i);
    Eigen::Isometry3d in_parent = link.parent_from_joint;
    if (link.prismatic) {
      in_parent.translate(q[k] * link.axis);
    } else {
      in_parent.rotate(Eigen::AngleAxisd(q[k], link.axis));
    }
    Motion& here = motions[i];
    here.parent_from_link = in_parent.linear();
    here.origin_in_parent = in_parent.translation();
    const bool on_base = link.parent < 0;
    const Motion* parent = on_base ? nullptr : &motions[static_cast<std::size_t>(link.parent)];
    const Vector3d w_p = on_base ? zero : parent->w;
    const Vector3d dw_p = on_base ? zero : parent->dw;
    const Vector3d a_p = on_base ? Vector3d(-gravity_) : parent->a;
    const Matrix3d back = here.parent_from_link.transpose();
    const Vector3d& p = here.origin_in_parent;
    const Vector3d w = back * w_p;
    const Vector3d dw = back * dw_p;
    here.a = back * (a_p + dw_p.cross(p) + w_p.cross(w_p.cross(p)));
    here.w = w;
    here.dw = dw;
    if (link.prismatic) {
      here.a += a[k] * link.axis + 2.0 * w.cross(v[k] * link.axis);
    } else {
      here.w += v[k] * link.axis;
      here.dw += a[k] * link.axis + w.cross(v[k] * link.axis);
    }
  }
  return motions;
}

Eigen::MatrixXd ArmDynamics::Regressor(const Eigen::Ref<const Eigen::VectorXd>& q,
                                       const Eigen::Ref<const Eigen::VectorXd>& v,
                                       const Eigen::Ref<const Eigen::VectorXd>& a) const {
  const std::vector<Motion> motions = Forward(q, v, a);
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(joints(), parameters());
  using Columns = Eigen::Matrix<double, 3, kParametersPerBody>;
  for (int i = 0; i < joints(); ++i) {
    const Motion& m = motions[static_cast<std::size_t>(i)];
    Columns f = Columns::Zero(), n = Columns::Zero();
    f.col(0) = m.a;
    f.block<3, 3>(0, 1) = Cross(m.dw) + Cross(m.w) * Cross(m.w);
    n.block<3, 3>(0, 1) = -Cross(m.a);
    n.block<3, 6>(0, 4) = Dot(m.dw) + Cross(m.w) * Dot(m.w);
    // Down to the base: every joint on the way carries this body.
    for (int j = i; j >= 0;) {
      const Link& link = links_[static_cast<std::size_t>(j)];
      Y.block<1, kParametersPerBody>(j, kParametersPerBody * i) =
          link.axis.transpose() * (link.prismatic ? f : n);
      const Motion& to_parent = motions[static_cast<std::size_t>(j)];
      const Columns f_parent = to_parent.parent_from_link * f;
      n = to_parent.parent_from_link * n + Cross(to_parent.origin_in_parent) * f_parent;
      f = f_parent;
      j = link.parent;
    }
  }
  return Y;
}

Eigen::VectorXd ArmDynamics::Torque(const Eigen::Ref<const Eigen::VectorXd>& q,
                                    const Eigen::Ref<const Eigen::VectorXd>& v,
                                    const Eigen::Ref<const Eigen::VectorXd>& a,
                                    const Eigen::Ref<const Eigen::VectorXd>& phi) const {
  const std::vector<Motion> motions = Forward(q, v, a);
  std::vector<Vector3d> f(links_.size()), n(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Inertial body =
        phi.segment<kParametersPerBody>(kParametersPerBody * static_cast<Eigen::Index>(i));
    const Motion& m = motions[i];
    const Vector3d moment = body.segment<3>(1);
    const Matrix3d inertia = InertiaOf(body);
    f[i] = body[0] * m.a + m.dw.cross(moment) + m.w.cross(m.w.cross(moment));
    n[i] = moment.cross(m.a) + inertia * m.dw + m.w.cross(inertia * m.w);
  }
  Eigen::VectorXd torque(joints());
  for (std::size_t i = links_.size(); i-- > 0;) {
    const Link& link = links_[i];
    torque[static_cast<Eigen::Index>(i)] = link.axis.dot(link.prismatic ? f[i] : n[i]);
    if (link.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(link.parent);
    const Vector3d f_parent = motions[i].parent_from_link * f[i];
    f[parent] += f_parent;
    n[parent] += motions[i].parent_from_link * n[i] + motions[i].origin_in_parent.cross(f_parent);
  }
  return torque;
}

Eigen::VectorXd BaseParameters::Of(const Eigen::Ref<const Eigen::VectorXd>& phi) const {
  Eigen::VectorXd beta(static_cast<Eigen::Index>(independent.size()));
  Eigen::VectorXd rest(static_cast<Eigen::Index>(dependent.size()));
  for (Eigen::Index i = 0; i < beta.size(); ++i) {
    beta[i] = phi[independent[static_cast<std::size_t>(i)]];
  }
  for (Eigen::Index i = 0; i < rest.size(); ++i) {
    rest[i] = phi[dependent[static_cast<std::size_t>(i)]];
  }
  if (rest.size() > 0) beta += K * rest;
  return beta;
}

BaseParameters FindBaseParameters(const ArmDynamics& dynamics, unsigned seed) {
  const int n = dynamics.joints();
  const int p = dynamics.parameters();
  const int states = 4 * kParametersPerBody + p;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(-3.0, 3.0), rate(-2.0, 2.0);
  Eigen::MatrixXd Y(states * n, p);
  for (int s = 0; s < states; ++s) {
    Eigen::VectorXd q(n), v(n), a(n);
    for (int i = 0; i < n; ++i) {
      q[i] = angle(random);
      v[i] = rate(random);
      a[i] = 3.0 * rate(random);
    }
    Y.middleRows(s * n, n) = dynamics.Regressor(q, v, a);
  }
  constexpr double kRank = 1e-9;  // regressors are exact to 1e-13 or so
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(Y);
  qr.setThreshold(kRank);
  const Eigen::Index rank = qr.rank();
  BaseParameters base;
  const auto& order = qr.colsPermutation().indices();
  for (Eigen::Index i = 0; i < p; ++i) {
    (i < rank ? base.independent : base.dependent).push_back(order[i]);
  }
  const Eigen::MatrixXd R = qr.matrixQR().topRows(rank).triangularView<Eigen::Upper>();
  base.K = R.leftCols(rank).triangularView<Eigen::Upper>().solve(R.rightCols(p - rank));
  return base;
}

}  // namespace sinew::arm
