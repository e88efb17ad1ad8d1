#include "bench/floating_world/floating_world.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::world {

namespace {

void CheckContact(const ContactPoint& contact, int bodies) {
  if (contact.body < kBaseBody || contact.body >= bodies) {
    throw std::invalid_argument("contact '" + contact.name + "' is on body " +
                                std::to_string(contact.body) + ", expected -1 (the base) to " +
                                std::to_string(bodies - 1));
  }
  if (!contact.point_m.allFinite()) {
    throw std::invalid_argument("contact '" + contact.name + "': its point is not finite");
  }
}

void CheckElastic(const ElasticJoint& elastic, int joints) {
  const std::string name = "elastic joint " + std::to_string(elastic.joint);
  if (elastic.joint < 0 || elastic.joint >= joints) {
    throw std::invalid_argument(name + ", expected 0 to " + std::to_string(joints - 1));
  }
  if (!(elastic.stiffness_Nm_rad >= 0.0) || !(elastic.damping_Nm_s_rad >= 0.0) ||
      !std::isfinite(elastic.stiffness_Nm_rad) || !std::isfinite(elastic.damping_Nm_s_rad) ||
      !std::isfinite(elastic.rest_rad)) {
    throw std::invalid_argument(name + ": stiffness " + std::to_string(elastic.stiffness_Nm_rad) +
                                ", damping " + std::to_string(elastic.damping_Nm_s_rad) +
                                ", rest " + std::to_string(elastic.rest_rad) +
                                ", expected finite and not below 0");
  }
}

bool IsFinite(const FloatingState& state) {
  return state.position_m.allFinite() && state.orientation.coeffs().allFinite() &&
         state.joint_position_rad.allFinite() && state.velocity.allFinite();
}

}  // namespace

FloatingWorld::FloatingWorld(const FloatingWorldConfig& config)
    : chain_(config.chain, config.gravity_m_s2),
      ground_(config.ground),
      contacts_(config.contacts),
      elastic_joints_(config.elastic_joints),
      base_from_imu_(config.base_from_imu),
      substep_s_(config.substep_s) {
  if (!(substep_s_ > 0.0) || !std::isfinite(substep_s_)) {
    throw std::invalid_argument("substep_s = " + std::to_string(substep_s_) + ", expected above 0");
  }
  if (!config.gravity_m_s2.allFinite() || !base_from_imu_.matrix().allFinite()) {
    throw std::invalid_argument("gravity or the frame of the IMU is not finite");
  }
  for (const ContactPoint& contact : contacts_) CheckContact(contact, chain_.body_count());
  for (const ElasticJoint& elastic : elastic_joints_) CheckElastic(elastic, chain_.joint_count());
  memory_.resize(contacts_.size());
  next_memory_.resize(contacts_.size());
  contact_forces_.resize(contacts_.size());
  next_forces_.resize(contacts_.size());
  forces_.resize(contacts_.size() + kMostPushes);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    forces_[i].body = contacts_[i].body;
    forces_[i].point_m = contacts_[i].point_m;
  }
  input_Nm_ = torque_Nm_ = Eigen::VectorXd::Zero(chain_.joint_count());
  acceleration_ = Eigen::VectorXd::Zero(chain_.freedom());
  Reset(chain_.Rest());
  // The first calls allocate.
  chain_.Solve(torque_Nm_, {}, acceleration_);
}

void FloatingWorld::Reset(const FloatingState& state) {
  if (state.joint_position_rad.size() != chain_.joint_count() ||
      state.velocity.size() != chain_.freedom()) {
    throw std::invalid_argument("a state of " + std::to_string(state.joint_position_rad.size()) +
                                " joints, expected " + std::to_string(chain_.joint_count()));
  }
  if (!IsFinite(state) || !(state.orientation.norm() > 0.0)) {
    throw std::invalid_argument("the state is not finite, or its orientation is 0");
  }
  state_ = state;
  state_.orientation.normalize();
  middle_ = state_;
  std::fill(memory_.begin(), memory_.end(), ContactMemory{});
  std::fill(contact_forces_.begin(), contact_forces_.end(), ContactForce{});
  chain_.SetState(state_);
  imu_ = {};
  imu_.angular_velocity_rad_s = base_from_imu_.linear().transpose() *
                                (state_.orientation.conjugate() * state_.velocity.head<3>());
}

bool FloatingWorld::TakeInput(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm,
                              std::span<const LinkForce> pushes, std::size_t* push_count) noexcept {
  bool good = torque_Nm.size() == input_Nm_.size() && pushes.size() <= kMostPushes;
  for (Eigen::Index j = 0; j < input_Nm_.size(); ++j) {
    const bool usable = j < torque_Nm.size() && std::isfinite(torque_Nm[j]);
    good = good && usable;
    input_Nm_[j] = usable ? torque_Nm[j] : 0.0;
  }
  *push_count = 0;
  for (const LinkForce& push : pushes.first(std::min(pushes.size(), kMostPushes))) {
    const bool usable = push.body >= kBaseBody && push.body < chain_.body_count() &&
                        push.point_m.allFinite() && push.force_N.allFinite();
    good = good && usable;
    if (usable) forces_[contacts_.size() + (*push_count)++] = push;
  }
  return good;
}

void FloatingWorld::Accelerate(std::size_t push_count) noexcept {
  chain_.SetState(middle_);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const PointMotion at = chain_.Point(contacts_[i].body, contacts_[i].point_m);
    const GroundLaw::Result result = ground_.Force(at.position_m, at.velocity_m_s, memory_[i]);
    next_memory_[i] = result.memory;
    next_forces_[i] = result.force;
    forces_[i].force_N << result.force.tangential_N, result.force.normal_N;
  }
  torque_Nm_ = input_Nm_;
  for (const ElasticJoint& elastic : elastic_joints_) {
    torque_Nm_[elastic.joint] -=
        elastic.stiffness_Nm_rad * (middle_.joint_position_rad[elastic.joint] - elastic.rest_rad) +
        elastic.damping_Nm_s_rad * middle_.velocity[kBaseFreedom + elastic.joint];
  }
  chain_.Solve(torque_Nm_, std::span(forces_).first(contacts_.size() + push_count), acceleration_);
}

StepStatus FloatingWorld::Step(const Eigen::Ref<const Eigen::VectorXd>& torque_Nm,
                               std::span<const LinkForce> pushes) noexcept {
  std::size_t push_count = 0;
  const bool good = TakeInput(torque_Nm, pushes, &push_count);
  middle_ = state_;
  Drift(0.5 * substep_s_, &middle_);
  Accelerate(push_count);
  middle_.velocity += 0.5 * substep_s_ * acceleration_;
  Accelerate(push_count);
  middle_.velocity = state_.velocity + substep_s_ * acceleration_;
  // The mean velocity of the kick, where the second evaluation was made.
  const Eigen::Vector3d turning =
      state_.velocity.head<3>() + 0.5 * substep_s_ * acceleration_.head<3>();
  const Eigen::Quaterniond half_way = middle_.orientation;
  Drift(0.5 * substep_s_, &middle_);
  if (!IsFinite(middle_)) return StepStatus::kDiverged;
  std::swap(state_, middle_);
  std::swap(memory_, next_memory_);
  std::swap(contact_forces_, next_forces_);
  ReadImu(half_way, turning);
  return good ? StepStatus::kOk : StepStatus::kBadInput;
}

void FloatingWorld::ReadImu(const Eigen::Quaterniond& orientation,
                            const Eigen::Vector3d& angular_velocity) noexcept {
  const Eigen::Vector3d lever = orientation * base_from_imu_.translation();
  const Eigen::Vector3d turning = acceleration_.head<3>();
  const Eigen::Vector3d linear = acceleration_.segment<3>(3) + turning.cross(lever) +
                                 angular_velocity.cross(angular_velocity.cross(lever));
  const Eigen::Matrix3d imu_from_base = base_from_imu_.linear().transpose();
  imu_.specific_force_m_s2 =
      imu_from_base * (orientation.conjugate() * (linear - chain_.gravity_m_s2()));
  imu_.angular_velocity_rad_s =
      imu_from_base * (state_.orientation.conjugate() * state_.velocity.head<3>());
}

}  // namespace sinew::world
