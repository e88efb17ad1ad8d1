#include "components/model/arm/arm_loop.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
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

// change: of the base parameters; information: inverse of its covariance, may be singular. None:
// no single mass explains 95 % of the change, or its mass may as well be zero.
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

}  // namespace

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
