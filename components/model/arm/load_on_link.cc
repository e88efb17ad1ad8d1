#include "components/model/arm/load_on_link.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/LevenbergMarquardt>
#include <unsupported/Eigen/NumericalDiff>

namespace sinew::arm {

namespace {

// Less is not what happened, but a part of it. Provisional.
constexpr double kLeastShare = 0.95;
// Spread of a load's place: standard deviation of each coordinate in the link's frame, m. Without,
// a small mass far out stands for any moment.
constexpr double kWithin_m = 0.5;
// The same of a mass that the motion hardly shows, kg.
constexpr double kAnyMass_kg = 1e3;

// Residuals over mass and position: the base parameters in standard deviations, then the priors.
struct Misfit : Eigen::DenseFunctor<double> {
  // Root of the information times d beta / d phi of the link, and times the change; both must
  // outlive it.
  Misfit(const Eigen::MatrixXd& of_link, const Eigen::VectorXd& of_change)
      : DenseFunctor(4, static_cast<int>(of_change.size()) + 4),
        weighted(of_link),
        target(of_change) {}

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& out) const {
    const Inertial phi =
        InertialIn(Eigen::Isometry3d::Identity(), x[0], x.tail<3>(), Eigen::Matrix3d::Zero());
    out.resize(values());
    out << weighted * phi - target, x[0] / kAnyMass_kg, x.tail<3>() / kWithin_m;
    return 0;
  }

  const Eigen::MatrixXd& weighted;
  const Eigen::VectorXd& target;
};

// Change of the base parameters with the ten of link k (BaseParameters::Of is linear).
Eigen::MatrixXd OfLink(const ArmDynamics& dynamics, const BaseParameters& base, int k) {
  Eigen::MatrixXd out(base.K.rows(), kParametersPerBody);
  for (int i = 0; i < kParametersPerBody; ++i) {
    out.col(i) = base.Of(Eigen::VectorXd::Unit(dynamics.parameters(), kParametersPerBody * k + i));
  }
  return out;
}

}  // namespace

std::optional<LoadOnLink> FindLoad(const ArmDynamics& dynamics, const BaseParameters& base,
                                   const Eigen::VectorXd& change,
                                   const Eigen::MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const Eigen::MatrixXd root =
      eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::VectorXd target = root * change;
  std::optional<LoadOnLink> best;
  for (int k = 0; k < dynamics.joints(); ++k) {
    const Eigen::MatrixXd weighted = root * OfLink(dynamics, base, k);
    Eigen::NumericalDiff<Misfit> misfit(Misfit(weighted, target));
    // From the mass and its moments alone, which are linear.
    const Eigen::MatrixXd linear = weighted.leftCols(4);
    Eigen::MatrixXd normal = linear.transpose() * linear;
    normal(0, 0) += 1.0 / (kAnyMass_kg * kAnyMass_kg);
    normal.diagonal().array() += 1e-12 * normal.trace();
    const Eigen::VectorXd moments = normal.ldlt().solve(linear.transpose() * target);
    Eigen::VectorXd x(4);
    x << moments[0], (moments.tail<3>() / moments[0]).cwiseMax(-kWithin_m).cwiseMin(kWithin_m);
    if (!x.allFinite()) continue;
    Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Misfit>> solver(misfit);
    solver.minimize(x);
    Eigen::VectorXd left;
    misfit(x, left);
    Eigen::MatrixXd jacobian(misfit.values(), 4);
    misfit.df(x, jacobian);
    const Eigen::MatrixXd covariance =
        (jacobian.transpose() * jacobian).ldlt().solve(Eigen::MatrixXd::Identity(4, 4));
    LoadOnLink found;
    const std::string& mass = dynamics.parameter_names().at(
        static_cast<std::size_t>(kParametersPerBody * k));  // "link.m"
    found.link = mass.substr(0, mass.rfind('.'));
    found.mass_kg = x[0];
    found.half_width_95 = 1.96 * std::sqrt(std::max(0.0, covariance(0, 0)));
    found.position_m = x.tail<3>();
    found.share = 1.0 - left.squaredNorm() / target.squaredNorm();
    if (!best || found.share > best->share) best = std::move(found);
  }
  if (!best || !(best->share > kLeastShare) || std::abs(best->mass_kg) < best->half_width_95) {
    return std::nullopt;
  }
  return best;
}

}  // namespace sinew::arm
