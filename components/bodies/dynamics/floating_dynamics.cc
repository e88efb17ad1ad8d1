#include "components/bodies/dynamics/floating_dynamics.h"

#include <random>
#include <stdexcept>
#include <utility>

namespace sinew::arm {

FloatingDynamics::FloatingDynamics(const Chain& chain, const Eigen::Vector3d& gravity_m_s2)
    : gravity_(gravity_m_s2) {
  for (const Body& body : chain.bodies) {
    if (!body.weightless) continue;
    throw std::invalid_argument("link '" + body.link_name +
                                "': its gravity acts through a term of the joint model, expected "
                                "the URDF's on a floating base");
  }
  MovingLinks moving = MovingLinksOf(chain);
  links_ = std::move(moving.links);
  joint_names_ = std::move(moving.joint_names);
  nominal_.resize(parameters());
  nominal_.head<kParametersPerBody>() = moving.base;
  AppendParameterNames(chain.base.link_name, &parameter_names_);
  for (int i = 0; i < joints(); ++i) {
    const MovingLink& link = links_[static_cast<std::size_t>(i)];
    nominal_.segment<kParametersPerBody>(kParametersPerBody * (1 + i)) = link.inertial;
    AppendParameterNames(link.link_name, &parameter_names_);
  }
  motions_.resize(links_.size() + 1);
  wrenches_.resize(links_.size() + 1);
}

double FloatingDynamics::mass_kg() const {
  double mass_kg = 0.0;
  for (int i = 0; i <= joints(); ++i) mass_kg += nominal_[kParametersPerBody * i];
  return mass_kg;
}

FloatingMotion FloatingDynamics::Rest() const {
  FloatingMotion motion;
  motion.joint_position_rad = Eigen::VectorXd::Zero(joints());
  motion.velocity = motion.acceleration = Eigen::VectorXd::Zero(freedom());
  return motion;
}

void FloatingDynamics::Forward(const FloatingMotion& motion) noexcept {
  const Eigen::Matrix3d back = motion.orientation.toRotationMatrix().transpose();
  LinkMotion& base = motions_.front();
  base.w = back * motion.velocity.head<3>();
  base.dw = back * motion.acceleration.head<3>();
  base.a = back * (motion.acceleration.segment<3>(3) - gravity_);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    motions_[i + 1] = Outward(links_[i], motions_[static_cast<std::size_t>(links_[i].parent + 1)],
                              motion.joint_position_rad[k], motion.velocity[kBaseFreedom + k],
                              motion.acceleration[kBaseFreedom + k]);
  }
}

void FloatingDynamics::Force(const FloatingMotion& motion,
                             const Eigen::Ref<const Eigen::VectorXd>& phi,
                             Eigen::Ref<Eigen::VectorXd> force) noexcept {
  Forward(motion);
  for (std::size_t i = 0; i < wrenches_.size(); ++i) {
    wrenches_[i] = WrenchOf(motions_[i], phi.segment<kParametersPerBody>(
                                             kParametersPerBody * static_cast<Eigen::Index>(i)));
  }
  for (std::size_t i = links_.size(); i-- > 0;) {
    const MovingLink& link = links_[i];
    const LinkWrench& here = wrenches_[i + 1];
    force[kBaseFreedom + static_cast<Eigen::Index>(i)] =
        link.axis.dot(link.prismatic ? here.f : here.n);
    LinkWrench& parent = wrenches_[static_cast<std::size_t>(link.parent + 1)];
    const LinkWrench carried = Inward(motions_[i + 1], here);
    parent.f += carried.f;
    parent.n += carried.n;
  }
  const Eigen::Matrix3d rotation = motion.orientation.toRotationMatrix();
  force.head<3>() = rotation * wrenches_.front().n;
  force.segment<3>(3) = rotation * wrenches_.front().f;
}

Eigen::MatrixXd FloatingDynamics::Regressor(const FloatingMotion& motion) {
  Forward(motion);
  const Eigen::Matrix3d rotation = motion.orientation.toRotationMatrix();
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(freedom(), parameters());
  for (int i = 0; i <= joints(); ++i) {
    const Eigen::Index column = kParametersPerBody * i;
    WrenchColumns columns = ColumnsOf(motions_[static_cast<std::size_t>(i)]);
    for (int j = i - 1; j >= 0;) {
      const MovingLink& link = links_[static_cast<std::size_t>(j)];
      Y.block<1, kParametersPerBody>(kBaseFreedom + j, column) =
          link.axis.transpose() * (link.prismatic ? columns.f : columns.n);
      columns = Inward(motions_[static_cast<std::size_t>(j) + 1], columns);
      j = link.parent;
    }
    Y.block<3, kParametersPerBody>(0, column) = rotation * columns.n;
    Y.block<3, kParametersPerBody>(3, column) = rotation * columns.f;
  }
  return Y;
}

BaseParameters FindBaseParameters(FloatingDynamics& dynamics, unsigned seed) {
  const int rows = dynamics.freedom();
  const int states = 4 * kParametersPerBody + dynamics.parameters() / rows;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> angle(-3.0, 3.0), rate(-2.0, 2.0);
  FloatingMotion motion = dynamics.Rest();
  Eigen::MatrixXd Y(states * rows, dynamics.parameters());
  for (int s = 0; s < states; ++s) {
    for (double& q : motion.joint_position_rad) q = angle(random);
    for (double& v : motion.velocity) v = rate(random);
    for (double& a : motion.acceleration) a = 3.0 * rate(random);
    const Eigen::Vector3d turn(rate(random), rate(random), rate(random));
    motion.orientation = Eigen::AngleAxisd(turn.norm(), turn.normalized());
    Y.middleRows(s * rows, rows) = dynamics.Regressor(motion);
  }
  return BaseParametersOf(Y);
}

}  // namespace sinew::arm
