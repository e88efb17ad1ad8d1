#include "sim/world/rest_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace sinew::world {

namespace {

// Components of nu: turns about x and y, height.
constexpr int kTurnX = 0, kTurnY = 1, kHeight = 5;
constexpr Eigen::Index kBaseUnknowns = 3;

constexpr int kRounds = 100;           // Newton's method takes less than ten from a nearby start
constexpr double kLargestTurn = 0.02;  // rad or m a round: contacts come and go in between
constexpr double kDifference = 1e-6;   // rad or m: of central differences
constexpr double kShare = 1e-12;       // of the weight: what r is solved to

class RestProblem {
 public:
  RestProblem(const arm::Chain& bodies, const std::vector<RestContact>& contacts,
              const std::vector<RestSpring>& springs, const RestGround& ground,
              FloatingChain& chain)
      : bodies_(bodies), contacts_(contacts), springs_(springs), ground_(ground), chain_(chain) {
    jacobian_ = Eigen::Matrix3Xd::Zero(3, chain.freedom());
    force_ = Eigen::VectorXd::Zero(chain.freedom());
  }

  Eigen::Index size() const { return kBaseUnknowns + static_cast<Eigen::Index>(springs_.size()); }

  FloatingState Moved(const FloatingState& state, const Eigen::VectorXd& by) const {
    FloatingState moved = state;
    const Eigen::Vector3d turn(by[0], by[1], 0.0);
    if (const double angle = turn.norm(); angle > 0.0) {
      moved.orientation =
          Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * state.orientation;
      moved.orientation.normalize();
    }
    moved.position_m.z() += by[2];
    for (std::size_t i = 0; i < springs_.size(); ++i) {
      moved.joint_position_rad[springs_[i].joint] += by[kBaseUnknowns + Index(i)];
    }
    return moved;
  }

  Eigen::VectorXd Residual(const FloatingState& state) {
    chain_.SetState(state);
    force_.setZero();
    for (const RestContact& contact : contacts_) {
      const double depth_m =
          ground_.height_m - chain_.Point(contact.body, contact.point_m).position_m.z();
      if (depth_m <= 0.0) continue;
      Add(contact.body, contact.point_m, {0.0, 0.0, ground_.stiffness_N_m * depth_m});
    }
    Add(kBaseBody, bodies_.base.com_m, bodies_.base.mass_kg * chain_.gravity_m_s2());
    for (std::size_t b = 0; b < bodies_.bodies.size(); ++b) {
      const arm::Body& body = bodies_.bodies[b];
      Add(static_cast<int>(b), body.com_m, body.mass_kg * chain_.gravity_m_s2());
    }
    Eigen::VectorXd residual(size());
    residual.head<kBaseUnknowns>() << force_[kTurnX], force_[kTurnY], force_[kHeight];
    for (std::size_t i = 0; i < springs_.size(); ++i) {
      const RestSpring& spring = springs_[i];
      residual[kBaseUnknowns + Index(i)] =
          force_[kBaseFreedom + spring.joint] -
          spring.stiffness_Nm_rad * state.joint_position_rad[spring.joint];
    }
    return residual;
  }

  // -dr/dx.
  Eigen::MatrixXd Stiffness(const FloatingState& state) {
    Eigen::MatrixXd stiffness(size(), size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      const Eigen::VectorXd by = kDifference * Eigen::VectorXd::Unit(size(), i);
      stiffness.col(i) =
          (Residual(Moved(state, -by)) - Residual(Moved(state, by))) / (2.0 * kDifference);
    }
    return stiffness;
  }

 private:
  static Eigen::Index Index(std::size_t i) { return static_cast<Eigen::Index>(i); }

  void Add(int body, const Eigen::Vector3d& point_m, const Eigen::Vector3d& force_N) {
    chain_.Jacobian(body, point_m, jacobian_);
    force_.noalias() += jacobian_.transpose() * force_N;
  }

  const arm::Chain& bodies_;
  const std::vector<RestContact>& contacts_;
  const std::vector<RestSpring>& springs_;
  RestGround ground_;
  FloatingChain& chain_;
  Eigen::Matrix3Xd jacobian_;
  Eigen::VectorXd force_;
};

}  // namespace

FloatingState RestPose(const arm::Chain& bodies, const std::vector<RestContact>& contacts,
                       const std::vector<RestSpring>& springs, const RestGround& ground,
                       const FloatingState& start, FloatingChain& chain) {
  RestProblem problem(bodies, contacts, springs, ground, chain);
  const double enough_N = kShare * chain.mass_kg() * chain.gravity_m_s2().norm();
  FloatingState state = start;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd residual = problem.Residual(state);
    const Eigen::MatrixXd stiffness = problem.Stiffness(state);
    if (residual.cwiseAbs().maxCoeff() <= enough_N) {
      const Eigen::MatrixXd symmetric = 0.5 * (stiffness + stiffness.transpose());
      if (Eigen::LLT<Eigen::MatrixXd>(symmetric).info() != Eigen::Success) break;
      chain.SetState(state);
      return state;
    }
    Eigen::VectorXd by = stiffness.partialPivLu().solve(residual);
    if (!by.allFinite()) break;
    by *= std::min(1.0, kLargestTurn / by.cwiseAbs().maxCoeff());
    state = problem.Moved(state, by);
  }
  throw std::invalid_argument(
      "no pose at rest: with its joints held as at the start the robot falls over");
}

}  // namespace sinew::world
