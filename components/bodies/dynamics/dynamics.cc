#include "components/bodies/dynamics/dynamics.h"

#include <Eigen/QR>
#include <random>
#include <stdexcept>
#include <utility>

namespace sinew::arm {

ArmDynamics::ArmDynamics(const Chain& chain, const Eigen::Vector3d& gravity_m_s2)
    : gravity_(gravity_m_s2) {
  MovingLinks moving = MovingLinksOf(chain);
  if (moving.links.empty()) {
    throw std::invalid_argument("robot '" + chain.name + "' has no moving joint");
  }
  links_ = std::move(moving.links);
  joint_names_ = std::move(moving.joint_names);
  nominal_.resize(parameters());
  for (int i = 0; i < joints(); ++i) {
    const MovingLink& link = links_[static_cast<std::size_t>(i)];
    nominal_.segment<kParametersPerBody>(kParametersPerBody * i) = link.inertial;
    AppendParameterNames(link.link_name, &parameter_names_);
  }
}

std::vector<LinkMotion> ArmDynamics::Forward(const Eigen::Ref<const Eigen::VectorXd>& q,
                                             const Eigen::Ref<const Eigen::VectorXd>& v,
                                             const Eigen::Ref<const Eigen::VectorXd>& a) const {
  LinkMotion base;
  base.a = -gravity_;
  std::vector<LinkMotion> motions(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const int parent = links_[i].parent;
    const auto k = static_cast<Eigen::Index>(i);
    motions[i] = Outward(links_[i], parent < 0 ? base : motions[static_cast<std::size_t>(parent)],
                         q[k], v[k], a[k]);
  }
  return motions;
}

Eigen::MatrixXd ArmDynamics::Regressor(const Eigen::Ref<const Eigen::VectorXd>& q,
                                       const Eigen::Ref<const Eigen::VectorXd>& v,
                                       const Eigen::Ref<const Eigen::VectorXd>& a) const {
  const std::vector<LinkMotion> motions = Forward(q, v, a);
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(joints(), parameters());
  for (int i = 0; i < joints(); ++i) {
    WrenchColumns columns = ColumnsOf(motions[static_cast<std::size_t>(i)]);
    // Down to the base: every joint on the way carries this body.
    for (int j = i; j >= 0;) {
      const MovingLink& link = links_[static_cast<std::size_t>(j)];
      Y.block<1, kParametersPerBody>(j, kParametersPerBody * i) =
          link.axis.transpose() * (link.prismatic ? columns.f : columns.n);
      columns = Inward(motions[static_cast<std::size_t>(j)], columns);
      j = link.parent;
    }
  }
  return Y;
}

Eigen::VectorXd ArmDynamics::Torque(const Eigen::Ref<const Eigen::VectorXd>& q,
                                    const Eigen::Ref<const Eigen::VectorXd>& v,
                                    const Eigen::Ref<const Eigen::VectorXd>& a,
                                    const Eigen::Ref<const Eigen::VectorXd>& phi) const {
  const std::vector<LinkMotion> motions = Forward(q, v, a);
  std::vector<LinkWrench> wrenches(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    wrenches[i] = WrenchOf(motions[i], phi.segment<kParametersPerBody>(
                                           kParametersPerBody * static_cast<Eigen::Index>(i)));
  }
  Eigen::VectorXd torque(joints());
  for (std::size_t i = links_.size(); i-- > 0;) {
    const MovingLink& link = links_[i];
    torque[static_cast<Eigen::Index>(i)] =
        link.axis.dot(link.prismatic ? wrenches[i].f : wrenches[i].n);
    if (link.parent < 0) continue;
    LinkWrench& parent = wrenches[static_cast<std::size_t>(link.parent)];
    const LinkWrench carried = Inward(motions[i], wrenches[i]);
    parent.f += carried.f;
    parent.n += carried.n;
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

BaseParameters BaseParametersOf(const Eigen::Ref<const Eigen::MatrixXd>& regressors) {
  constexpr double kRank = 1e-9;  // regressors are exact to 1e-13 or so
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(regressors);
  qr.setThreshold(kRank);
  const Eigen::Index p = regressors.cols();
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
  return BaseParametersOf(Y);
}

}  // namespace sinew::arm
