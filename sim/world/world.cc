#include "sim/world/world.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/types/joints.h"
#include "sim/plant/friction.h"

namespace sinew::world {

namespace {

arm::Chain WithModelsLinks(arm::Chain chain, const actuator::RobotModel& model) {
  CheckModelOfChain(chain, model);
  for (const arm::Body& body : chain.bodies) {
    if (body.passive) {
      throw std::invalid_argument("joint '" + body.joint_name +
                                  "' is passive in the URDF: only a robot on a floating base may "
                                  "have such joints");
    }
  }
  for (const actuator::JointModel& joint : model.joints) {
    const bool has_gravity = joint.Find("gravity") >= 0;
    const bool has_inertia = joint.Find("link_inertia") >= 0 || joint.Find("inertia") >= 0;
    if (!has_gravity && !has_inertia) continue;
    const double inertia = plant::JointPlant::LinkInertia(joint);
    if (has_inertia && !(inertia > 0.0)) {
      throw std::invalid_argument("joint '" + joint.name + "': the model's inertia is " +
                                  std::to_string(inertia) + ", expected above 0");
    }
    const int body = arm::FindJoint(chain, joint.name);
    arm::OverrideLink(chain, body, has_inertia ? inertia : 0.0, has_gravity);
  }
  return chain;
}

}  // namespace

World::World(const WorldConfig& config)
    : chain_(WithModelsLinks(config.chain, config.model)),
      joints_(config.chain, config.model, config.joints),
      substep_s_(config.substep_s) {
  if (!(substep_s_ > 0.0) || !std::isfinite(substep_s_)) {
    throw std::invalid_argument("substep_s = " + std::to_string(substep_s_));
  }
  const int n = chain_.joint_count();
  for (JointVector* vector : {&position_, &velocity_, &chain_position_, &chain_velocity_,
                              &acceleration_, &torque_, &added_, &lower_, &upper_, &impulse_}) {
    *vector = JointVector::Zero(n);
  }
  inverse_ = mixed_ = JointMatrix::Zero(n, n);
  provider::PlantSensors sensors;
  Reset(&sensors);
}

void World::Reset(provider::PlantSensors* sensors) {
  for (int j = 0; j < joints_.count(); ++j) {
    position_[j] = joints_.start_position_rad(j);
    velocity_[j] = 0.0;
  }
  SolveChain();
  types::JointArray<double> body_inertia_kg_m2{};
  for (int j = 0; j < joints_.count(); ++j) {
    const int c = joints_.chain_joint(j);
    body_inertia_kg_m2[static_cast<std::size_t>(j)] = 1.0 / inverse_(c, c);
  }
  joints_.Reset(body_inertia_kg_m2);
  ReadSensors(sensors);
}

void World::Start(int index, const effects::JointSample& x, std::span<const double> memory) {
  position_[index] = x.position_rad;
  velocity_[index] = x.velocity_rad_s;
  SolveChain();
  const int c = joints_.chain_joint(index);
  joints_.Start(index, x, 1.0 / inverse_(c, c), memory);
}

void World::SolveChain() noexcept {
  for (int j = 0; j < joints_.count(); ++j) {
    const int c = joints_.chain_joint(j);
    chain_position_[c] = position_[j];
    chain_velocity_[c] = velocity_[j];
  }
  chain_.SetState(chain_position_, chain_velocity_);
  chain_.Solve(&acceleration_, &inverse_);
}

void World::Step(const provider::PlantCommand& command, double period_s,
                 provider::PlantSensors* sensors) {
  joints_.Command(command);
  const long steps = std::max(1L, std::lround(std::ceil(period_s / substep_s_ - 1e-9)));
  const double dt = period_s / static_cast<double>(steps);
  for (long k = 0; k < steps; ++k) Substep(dt);
  ReadSensors(sensors);
}

void World::Substep(double dt_s) noexcept {
  const int n = joints_.count();
  for (int j = 0; j < n; ++j) position_[j] += 0.5 * dt_s * velocity_[j];
  SolveChain();
  for (int j = 0; j < n; ++j) {
    const int c = joints_.chain_joint(j);
    const JointLoad load = joints_.Begin(j, position_[j], velocity_[j], dt_s);
    torque_[c] = load.torque_Nm;
    added_[c] = load.added_inertia_kg_m2;
    lower_[c] = load.lower_Nms;
    upper_[c] = load.upper_Nms;
  }
  if (n == 1) {
    const double share = 1.0 / (1.0 + inverse_(0, 0) * added_[0]);
    chain_velocity_[0] += dt_s * share * (acceleration_[0] + inverse_(0, 0) * torque_[0]);
    inverse_(0, 0) *= share;
  } else {
    mixed_.noalias() = inverse_ * added_.asDiagonal();
    mixed_.diagonal().array() += 1.0;
    const Eigen::PartialPivLU<JointMatrix> solver(mixed_);
    acceleration_.noalias() += inverse_ * torque_;
    chain_velocity_ += dt_s * solver.solve(acceleration_);
    mixed_ = solver.solve(inverse_);
    inverse_ = 0.5 * (mixed_ + mixed_.transpose());
  }
  const auto size = static_cast<std::size_t>(n);
  plant::ApplyImpulses({inverse_.data(), size * size}, {lower_.data(), size}, {upper_.data(), size},
                       {impulse_.data(), size}, {chain_velocity_.data(), size});
  for (int j = 0; j < n; ++j) {
    velocity_[j] = chain_velocity_[joints_.chain_joint(j)];
    position_[j] += 0.5 * dt_s * velocity_[j];
    joints_.End(j, position_[j], velocity_[j], dt_s);
  }
}

void World::ReadSensors(provider::PlantSensors* sensors) {
  *sensors = provider::PlantSensors{};
  for (int j = 0; j < joints_.count(); ++j) {
    joints_.Read(j, position_[j], velocity_[j], sensors, &truth_);
  }
}

}  // namespace sinew::world
