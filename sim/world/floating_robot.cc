#include "sim/world/floating_robot.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "components/base/types/joints.h"
#include "sim/plant/friction.h"
#include "sim/world/rest_pose.h"

namespace sinew::world {

namespace {

void CheckRobot(const FloatingRobotConfig& config) {
  if (!(config.substep_s > 0.0) || !std::isfinite(config.substep_s)) {
    throw std::invalid_argument("substep_s = " + std::to_string(config.substep_s) +
                                ", expected above 0");
  }
  if (config.base_height_m && !std::isfinite(*config.base_height_m)) {
    throw std::invalid_argument("base_height_m = " + std::to_string(*config.base_height_m));
  }
  if (config.base_height_m && config.start == StartPose::kAtRest) {
    throw std::invalid_argument("a start at rest has its own height, expected no base_height_m");
  }
  for (const actuator::JointModel& joint : config.model.joints) {
    for (const char* term : {"gravity", "link_inertia", "inertia"}) {
      if (joint.Find(term) < 0) continue;
      throw std::invalid_argument("joint '" + joint.name + "': the model's " + term +
                                  " belongs in the URDF of a robot on a floating base");
    }
  }
  for (const WorldJointConfig& joint : config.joints) {
    if (joint.declared_payload_kg == 0.0) continue;
    throw std::invalid_argument("a declared payload of " +
                                std::to_string(joint.declared_payload_kg) +
                                " kg, expected 0: on a floating base it belongs in the URDF");
  }
}

// Streams of the seed.
constexpr std::uint64_t kForceStream = 0, kRateStream = 1, kFeetStream = 2;
constexpr std::size_t kAxes = 3;

template <typename Array>
void CopyTo(const Eigen::Vector3d& from, Array* to) {
  std::copy_n(from.data(), 3, to->begin());
}

void CopyQuaternion(const Eigen::Quaterniond& from, std::array<double, 4>* wxyz) {
  *wxyz = {from.w(), from.x(), from.y(), from.z()};
}

Eigen::Vector3d ToVector(const std::array<double, 3>& from) { return {from[0], from[1], from[2]}; }

}  // namespace

FloatingRobot::FloatingRobot(const FloatingRobotConfig& config)
    : merged_(arm::MergeFixedLinks(config.chain)),
      chain_(merged_.chain),
      joints_(merged_.chain, config.model, config.joints),
      ground_config_(config.ground),
      ground_(config.ground),
      substep_s_(config.substep_s),
      noise_(config.noise),
      factor_(chain_.parents()),
      force_axes_("the IMU's specific force", config.imu_errors.force, kAxes, config.seed,
                  kForceStream),
      rate_axes_("the IMU's angular velocity", config.imu_errors.rate, kAxes, config.seed,
                 kRateStream),
      feet_("the feet's force sensors", config.foot_errors,
            std::min(config.contacts.size(), foot_force_N_.size()), config.seed, kFeetStream) {
  CheckRobot(config);
  const int n = chain_.joint_count();
  for (const ContactFrame& frame : config.contacts) {
    const arm::LinkFrame& link = Link(frame.link, "contact");
    if (!frame.point_m.allFinite()) {
      throw std::invalid_argument("contact on link '" + frame.link + "': its point is not finite");
    }
    contacts_.push_back({.body = link.body,
                         .point_m = link.body_from_link * frame.point_m,
                         .memory = {},
                         .jacobian = Eigen::Matrix3Xd::Zero(3, chain_.freedom())});
    forces_.push_back({.body = link.body, .point_m = contacts_.back().point_m});
    damping_.push_back({.body = link.body, .point_m = contacts_.back().point_m});
  }
  forces_.push_back({});  // the push
  contact_forces_.resize(contacts_.size());
  for (int c = 0; c < n; ++c) {
    const int body_index = chain_.joint_bodies()[static_cast<std::size_t>(c)];
    const arm::Body& body = merged_.chain.bodies[static_cast<std::size_t>(body_index)];
    if (!body.passive) continue;
    passive_.push_back(
        {.joint = c, .law = *body.passive, .lower = body.lower, .upper = body.upper});
  }
  if (!config.imu_link.empty()) {
    const arm::LinkFrame& link = Link(config.imu_link, "IMU");
    if (link.body != kBaseBody) {
      throw std::invalid_argument("IMU on link '" + config.imu_link +
                                  "', which moves: expected one fixed to the base");
    }
    base_from_imu_ = link.body_from_link;
  }
  for (Eigen::VectorXd* vector :
       {&torque_, &added_, &lower_, &upper_, &impulse_, &joint_velocity_}) {
    *vector = Eigen::VectorXd::Zero(n);
  }
  for (Eigen::VectorXd* vector : {&ahead_, &acceleration_, &chain_acceleration_, &change_}) {
    *vector = Eigen::VectorXd::Zero(chain_.freedom());
  }
  inertia_ = Eigen::MatrixXd::Zero(chain_.freedom(), chain_.freedom());
  joint_inverse_ = Eigen::MatrixXd::Zero(n, n);
  start_ = chain_.Rest();
  for (int j = 0; j < joints_.count(); ++j) {
    start_.joint_position_rad[joints_.chain_joint(j)] = joints_.start_position_rad(j);
  }
  start_.position_m.z() = StartHeight(start_, config.base_height_m);
  if (config.start == StartPose::kAtRest) start_ = AtRest(start_);
  before_ = state_ = start_;
  chain_.Solve(torque_, {}, chain_acceleration_);  // the first call allocates
  provider::PlantSensors sensors;
  Reset(&sensors);
}

const arm::LinkFrame& FloatingRobot::Link(const std::string& name, const std::string& what) const {
  const arm::LinkFrame* link = arm::FindLink(merged_, name);
  if (link == nullptr) {
    throw std::invalid_argument(what + " on link '" + name + "', which is not in the URDF");
  }
  return *link;
}

// With the contacts by height above the base, lowest first, the first m of them touch when their
// depths below the ground add up to weight / k: the height follows, and the next one must be above
// the ground.
double FloatingRobot::StartHeight(const FloatingState& upright, std::optional<double> asked_m) {
  if (asked_m) return *asked_m;
  if (contacts_.empty()) {
    throw std::invalid_argument("no contact to stand on: expected contacts or base_height_m");
  }
  chain_.SetState(upright);
  std::vector<double> above_m;
  for (const Contact& contact : contacts_) {
    above_m.push_back(chain_.Point(contact.body, contact.point_m).position_m.z());
  }
  std::sort(above_m.begin(), above_m.end());
  const double depth_sum_m =
      -chain_.mass_kg() * chain_.gravity_m_s2().z() / ground_.stiffness_N_m();
  double sum_m = 0.0, height_m = 0.0;
  for (std::size_t m = 0; m < above_m.size(); ++m) {
    sum_m += above_m[m];
    const auto touching = static_cast<double>(m + 1);
    height_m = ground_.height_m() - (sum_m + depth_sum_m) / touching;
    if (m + 1 < above_m.size() && height_m + above_m[m + 1] >= ground_.height_m()) break;
  }
  return height_m;
}

FloatingState FloatingRobot::AtRest(const FloatingState& upright) {
  std::vector<RestContact> contacts;
  for (const Contact& contact : contacts_) contacts.push_back({contact.body, contact.point_m});
  std::vector<RestSpring> springs;
  for (const PassiveJoint& passive : passive_) {
    springs.push_back({passive.joint, passive.law.stiffness_Nm_rad});
  }
  const RestGround ground{ground_.height_m(), ground_.stiffness_N_m()};
  FloatingState rest = RestPose(merged_.chain, contacts, springs, ground, upright, chain_);
  for (const PassiveJoint& passive : passive_) {
    const double position = rest.joint_position_rad[passive.joint];
    if (position > passive.lower && position < passive.upper) continue;
    throw std::invalid_argument("no pose at rest: a passive joint would be at " +
                                std::to_string(position) + ", beyond its stop");
  }
  return rest;
}

void FloatingRobot::Reset(provider::PlantSensors* sensors) {
  SetPayload({});
  forces_.back() = {};
  ground_ = GroundLaw(ground_config_);
  state_ = start_;
  acceleration_.setZero();
  impulse_.setZero();
  diverged_ = false;
  random_.seed(noise_.seed);
  normal_.reset();
  chain_.SetState(state_);
  chain_.Inertia({}, inertia_);
  types::JointArray<double> body_inertia_kg_m2{};
  if (factor_.Factor(inertia_)) factor_.InverseFrom(kBaseFreedom, joint_inverse_);
  for (int j = 0; j < joints_.count(); ++j) {
    const int c = joints_.chain_joint(j);
    body_inertia_kg_m2[static_cast<std::size_t>(j)] = 1.0 / joint_inverse_(c, c);
  }
  joints_.Reset(body_inertia_kg_m2);
  for (Contact& contact : contacts_) contact.memory = {};
  TouchGround(0.0);
  specific_force_m_s2_ = state_.orientation.conjugate() * -chain_.gravity_m_s2();
  if (base_from_imu_)
    specific_force_m_s2_ = base_from_imu_->linear().transpose() * specific_force_m_s2_;
  const Eigen::Vector3d rate_rad_s = AngularVelocityOfImu();
  force_axes_.Reset({specific_force_m_s2_.data(), kAxes});
  rate_axes_.Reset({rate_rad_s.data(), kAxes});
  GatherFeet();
  feet_.Reset(foot_force_N_);
  ReadSensors(sensors);
}

void FloatingRobot::SetPayload(const Payload& payload) {
  if (payload == payload_) return;
  payload_ = payload;
  arm::Chain loaded = merged_.chain;
  if (!(payload.mass_kg > 0.0)) {
    // The chain of before, to the bit.
  } else if (payload.body == kBaseBody) {
    arm::AddPointMass(payload.mass_kg, payload.point_m, &loaded.base);
  } else {
    arm::AddPointMass(payload.mass_kg, payload.point_m,
                      &loaded.bodies[static_cast<std::size_t>(payload.body)]);
  }
  chain_ = FloatingChain(loaded);
  chain_.SetState(state_);
  chain_.Solve(torque_, {}, chain_acceleration_);  // the first call allocates
}

void FloatingRobot::DisturbBody(const provider::BodyDisturbance& disturbance) {
  const auto link = [this](const std::string& name) -> const arm::LinkFrame& {
    const arm::LinkFrame* found = arm::FindLink(merged_, name);
    return found != nullptr ? *found : merged_.frames.front();
  };
  Payload payload;
  const Eigen::Vector3d payload_m = ToVector(disturbance.payload_m);
  if (std::isfinite(disturbance.payload_kg) && disturbance.payload_kg > 0.0 &&
      payload_m.allFinite()) {
    const arm::LinkFrame& on = link(disturbance.payload_link);
    payload = {.body = on.body,
               .point_m = on.body_from_link * payload_m,
               .mass_kg = disturbance.payload_kg};
  }
  SetPayload(payload);
  LinkForce& push = forces_.back();
  push = {};
  const Eigen::Vector3d force_N = ToVector(disturbance.push_force_N);
  const Eigen::Vector3d push_m = ToVector(disturbance.push_m);
  if (force_N.allFinite() && push_m.allFinite()) {
    const arm::LinkFrame& on = link(disturbance.push_link);
    push = {.body = on.body, .point_m = on.body_from_link * push_m, .force_N = force_N};
  }
  joints_.LoseDrive(joints_.Find(disturbance.lost_drive));
  const double lost = disturbance.lost_friction;
  GroundConfig ground = ground_config_;
  if (lost > 0.0 && lost <= 1.0) ground.friction *= 1.0 - lost;
  ground_ = GroundLaw(ground);
}

void FloatingRobot::Step(const provider::PlantCommand& command, double period_s,
                         provider::PlantSensors* sensors) {
  joints_.Command(command);
  const long steps = std::max(1L, std::lround(std::ceil(period_s / substep_s_ - 1e-9)));
  const double dt = period_s / static_cast<double>(steps);
  for (long k = 0; k < steps && !diverged_; ++k) diverged_ = !Substep(dt);
  ReadSensors(sensors);
}

bool FloatingRobot::Substep(double dt_s) noexcept {
  before_ = state_;
  Drift(0.5 * dt_s, &state_);
  ahead_ = state_.velocity + 0.5 * dt_s * acceleration_;
  state_.velocity.swap(ahead_);
  chain_.SetState(state_);
  state_.velocity.swap(ahead_);
  TouchGround(dt_s);
  LoadJoints(dt_s);
  chain_.Solve(torque_, forces_, chain_acceleration_);
  if (!Kick(dt_s)) {
    state_ = before_;
    return false;
  }
  ReadContacts();
  ReadImu();
  Drift(0.5 * dt_s, &state_);
  for (int j = 0; j < joints_.count(); ++j) {
    const int c = joints_.chain_joint(j);
    joints_.End(j, state_.joint_position_rad[c], state_.velocity[kBaseFreedom + c], dt_s);
  }
  FollowSensors(dt_s);
  return true;
}

void FloatingRobot::TouchGround(double dt_s) noexcept {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& contact = contacts_[i];
    chain_.Jacobian(contact.body, contact.point_m, contact.jacobian);
    const Eigen::Vector3d velocity = contact.jacobian * state_.velocity;
    const PointMotion at = chain_.Point(contact.body, contact.point_m);
    const GroundLaw::Result result = ground_.Force(at.position_m, velocity, contact.memory);
    contact.memory = result.memory;
    contact_forces_[i] = result.force;
    forces_[i].force_N << result.force.tangential_N, result.force.normal_N;
    const double along = 0.5 * dt_s * result.tangential_damping_N_s_m;
    damping_[i].mass_kg << along, along, 0.5 * dt_s * result.normal_damping_N_s_m;
  }
}

void FloatingRobot::LoadJoints(double dt_s) noexcept {
  for (int j = 0; j < joints_.count(); ++j) {
    const int c = joints_.chain_joint(j);
    const JointLoad load =
        joints_.Begin(j, state_.joint_position_rad[c], state_.velocity[kBaseFreedom + c], dt_s);
    torque_[c] = load.torque_Nm;
    added_[c] = load.added_inertia_kg_m2;
    lower_[c] = load.lower_Nms;
    upper_[c] = load.upper_Nms;
  }
  for (const PassiveJoint& passive : passive_) {
    const int c = passive.joint;
    const double position = state_.joint_position_rad[c];
    torque_[c] = -passive.law.stiffness_Nm_rad * position -
                 passive.law.damping_Nms_rad * state_.velocity[kBaseFreedom + c];
    added_[c] = 0.5 * dt_s * passive.law.damping_Nms_rad;
    JointLoad stops;
    AddStops(position, passive.lower, passive.upper, &stops);
    lower_[c] = stops.lower_Nms;
    upper_[c] = stops.upper_Nms;
  }
}

// With H a the forces: M^-1 H a = a - M^-1 (R + h/2 C) a.
bool FloatingRobot::Kick(double dt_s) noexcept {
  const Eigen::Index n = added_.size();
  chain_.Inertia(damping_, inertia_);
  inertia_.diagonal().tail(n) += added_;
  change_.head<kBaseFreedom>().setZero();
  change_.tail(n) = added_.cwiseProduct(chain_acceleration_.tail(n));
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Eigen::Vector3d force =
        damping_[i].mass_kg.cwiseProduct(contacts_[i].jacobian * chain_acceleration_);
    change_.noalias() += contacts_[i].jacobian.transpose() * force;
  }
  if (!factor_.Factor(inertia_)) return false;
  factor_.Solve(change_);
  change_ = dt_s * (chain_acceleration_ - change_);
  joint_velocity_ = state_.velocity.tail(n) + change_.tail(n);
  factor_.InverseFrom(kBaseFreedom, joint_inverse_);
  const auto size = static_cast<std::size_t>(n);
  plant::ApplyImpulsesFrom({joint_inverse_.data(), size * size}, {lower_.data(), size},
                           {upper_.data(), size}, {impulse_.data(), size},
                           {joint_velocity_.data(), size});
  ahead_.head<kBaseFreedom>().setZero();
  ahead_.tail(n) = impulse_;
  factor_.Solve(ahead_);
  change_.head<kBaseFreedom>() += ahead_.head<kBaseFreedom>();
  change_.tail(n) = joint_velocity_ - state_.velocity.tail(n);
  if (!change_.allFinite()) return false;
  state_.velocity.head<kBaseFreedom>() += change_.head<kBaseFreedom>();
  state_.velocity.tail(n) = joint_velocity_;
  acceleration_ = change_ / dt_s;
  return true;
}

// The forces at nu less h/2 C times the acceleration: those at the mean of nu and nu'.
void FloatingRobot::ReadContacts() noexcept {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    ContactForce& force = contact_forces_[i];
    if (!contacts_[i].memory.touches) continue;
    const Eigen::Vector3d less =
        damping_[i].mass_kg.cwiseProduct(contacts_[i].jacobian * acceleration_);
    force.tangential_N -= less.head<2>();
    force.normal_N = std::max(0.0, force.normal_N - less.z());
  }
}

// Half-way: orientation there, mean of the angular velocities.
void FloatingRobot::ReadImu() noexcept {
  if (!base_from_imu_) return;
  const Eigen::Vector3d lever = state_.orientation * base_from_imu_->translation();
  const Eigen::Vector3d turning = acceleration_.head<3>();
  const Eigen::Vector3d angular = 0.5 * (before_.velocity.head<3>() + state_.velocity.head<3>());
  const Eigen::Vector3d linear =
      acceleration_.segment<3>(3) + turning.cross(lever) + angular.cross(angular.cross(lever));
  specific_force_m_s2_ = base_from_imu_->linear().transpose() *
                         (state_.orientation.conjugate() * (linear - chain_.gravity_m_s2()));
}

Eigen::Vector3d FloatingRobot::AngularVelocityOfImu() const noexcept {
  if (!base_from_imu_) return Eigen::Vector3d::Zero();
  return base_from_imu_->linear().transpose() *
         (state_.orientation.conjugate() * Eigen::Vector3d(state_.velocity.head<3>()));
}

void FloatingRobot::GatherFeet() noexcept {
  const std::size_t feet = std::min(contacts_.size(), foot_force_N_.size());
  for (std::size_t i = 0; i < feet; ++i) foot_force_N_[i] = contact_forces_[i].normal_N;
}

void FloatingRobot::FollowSensors(double dt_s) noexcept {
  const Eigen::Vector3d rate_rad_s = AngularVelocityOfImu();
  force_axes_.Follow({specific_force_m_s2_.data(), kAxes}, dt_s);
  rate_axes_.Follow({rate_rad_s.data(), kAxes}, dt_s);
  GatherFeet();
  feet_.Follow(foot_force_N_, dt_s);
}

void FloatingRobot::ReadSensors(provider::PlantSensors* sensors) {
  *sensors = provider::PlantSensors{};
  for (int j = 0; j < joints_.count(); ++j) {
    const int c = joints_.chain_joint(j);
    joints_.Read(j, state_.joint_position_rad[c], state_.velocity[kBaseFreedom + c], sensors,
                 &gear_truth_);
    if (diverged_) sensors->valid[static_cast<std::size_t>(j)] = false;
  }
  if (diverged_) {
    sensors->fault = true;
    sensors->message = "the simulation diverged";
  }
  const std::size_t feet = std::min(contacts_.size(), body_sensors_.foot_force_N.size());
  feet_.Read(std::span(body_sensors_.foot_force_N).first(feet));
  for (std::size_t i = 0; i < feet; ++i) {
    body_sensors_.foot_valid[i] = !diverged_;
    body_truth_.contact_force_N[i] = {contact_forces_[i].tangential_N.x(),
                                      contact_forces_[i].tangential_N.y(),
                                      contact_forces_[i].normal_N};
  }
  CopyTo(state_.position_m, &body_truth_.position_m);
  CopyQuaternion(state_.orientation, &body_truth_.orientation_wxyz);
  CopyTo(state_.velocity.segment<3>(3), &body_truth_.velocity_m_s);
  CopyTo(state_.velocity.head<3>(), &body_truth_.angular_velocity_rad_s);
  if (base_from_imu_) ReadOrientation();
  if (noise_.any()) AddNoise(sensors);
}

void FloatingRobot::ReadOrientation() noexcept {
  const Eigen::Quaterniond world_from_imu =
      state_.orientation * Eigen::Quaterniond(base_from_imu_->linear());
  force_axes_.Read(body_sensors_.acceleration_m_s2);
  rate_axes_.Read(body_sensors_.angular_velocity_rad_s);
  CopyQuaternion(world_from_imu.normalized(), &body_sensors_.orientation_wxyz);
  body_sensors_.imu_valid = !diverged_;
}

void FloatingRobot::AddNoise(provider::PlantSensors* sensors) noexcept {
  const auto add = [this](double deviation, double* value) {
    *value += deviation * normal_(random_);
  };
  for (int j = 0; j < joints_.count(); ++j) {
    if (!joints_.prismatic(j)) {
      add(noise_.motor_current_A, &sensors->motor_current_A[static_cast<std::size_t>(j)]);
    }
  }
  const std::size_t feet = std::min(contacts_.size(), body_sensors_.foot_force_N.size());
  for (std::size_t i = 0; i < feet; ++i) add(noise_.foot_force_N, &body_sensors_.foot_force_N[i]);
  if (!base_from_imu_) return;
  Eigen::Vector3d turn;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    turn[axis] = noise_.orientation_rad * normal_(random_);
    const auto k = static_cast<std::size_t>(axis);
    add(noise_.angular_velocity_rad_s, &body_sensors_.angular_velocity_rad_s[k]);
    add(noise_.acceleration_m_s2, &body_sensors_.acceleration_m_s2[k]);
  }
  const std::array<double, 4>& read = body_sensors_.orientation_wxyz;
  const Eigen::Quaterniond exact(read[0], read[1], read[2], read[3]);
  // A turn of a few milliradians: twice the vector part of its quaternion, to third order.
  const Eigen::Quaterniond off(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z());
  CopyQuaternion((exact * off).normalized(), &body_sensors_.orientation_wxyz);
}

}  // namespace sinew::world
