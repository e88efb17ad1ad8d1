// Random trees and states, by seed: inertias of plausible bodies with axes apart from the link's,
// fixed joints and prismatic ones among them.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "sim/world/floating_chain.h"

namespace sinew::world {

class RandomStates {
 public:
  explicit RandomStates(unsigned seed) : engine_(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  std::size_t Index(std::size_t size) {
    return std::uniform_int_distribution<std::size_t>(0, size - 1)(engine_);
  }
  Eigen::VectorXd Vector(int size, double bound) {
    return Eigen::VectorXd::NullaryExpr(size, [&] { return Uniform(-bound, bound); });
  }
  Eigen::Quaterniond Rotation() {
    const Eigen::Vector3d turn = Vector(3, M_PI / std::sqrt(3.0));
    return Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  FloatingState State(const FloatingChain& chain) {
    FloatingState state;
    state.position_m = Vector(3, 1.0);
    state.orientation = Rotation();
    state.joint_position_rad = Vector(chain.joint_count(), 2.0);
    state.velocity = Vector(chain.freedom(), 3.0);
    return state;
  }
  // On the base and every third body.
  std::vector<LinkForce> Forces(const FloatingChain& chain) {
    std::vector<LinkForce> forces;
    for (int body = kBaseBody; body < chain.body_count(); body += 3) {
      forces.push_back({body, Vector(3, 0.1), Vector(3, 50.0)});
    }
    return forces;
  }

 private:
  std::mt19937 engine_;
};

// Inertia of a box of random sides, turned.
inline Eigen::Matrix3d RandomInertia(RandomStates& random, double mass_kg) {
  const Eigen::Vector3d side(random.Uniform(0.05, 0.3), random.Uniform(0.05, 0.3),
                             random.Uniform(0.05, 0.3));
  const Eigen::Vector3d square = side.cwiseAbs2();
  const Eigen::Vector3d moments(square.y() + square.z(), square.x() + square.z(),
                                square.x() + square.y());
  const Eigen::Matrix3d axes = random.Rotation().toRotationMatrix();
  return mass_kg / 12.0 * axes * moments.asDiagonal() * axes.transpose();
}

// A tree with that many moving joints; every fifth body is fixed to its parent, every seventh joint
// slides.
inline arm::Chain RandomTree(unsigned seed, int moving) {
  RandomStates random(seed);
  arm::Chain chain;
  chain.name = "tree" + std::to_string(seed);
  chain.base.link_name = "base";
  chain.base.mass_kg = random.Uniform(1.0, 5.0);
  chain.base.com_m = random.Vector(3, 0.1);
  chain.base.inertia_kg_m2 = RandomInertia(random, chain.base.mass_kg);
  for (int k = 0, joints = 0; joints < moving; ++k) {
    arm::Body body;
    body.link_name = "link" + std::to_string(k);
    body.joint_name = "joint" + std::to_string(k);
    body.parent = static_cast<int>(std::floor(random.Uniform(std::max(-1.0, k - 4.0), k)));
    body.moves = k % 5 != 3;
    body.prismatic = body.moves && k % 7 == 5;
    joints += body.moves ? 1 : 0;
    body.parent_from_joint.translate(Eigen::Vector3d(random.Vector(3, 0.3)));
    body.parent_from_joint.rotate(random.Rotation());
    body.axis = Eigen::Vector3d(random.Vector(3, 1.0)).normalized();
    body.mass_kg = random.Uniform(0.1, 2.0);
    body.com_m = random.Vector(3, 0.1);
    body.inertia_kg_m2 = RandomInertia(random, body.mass_kg);
    chain.bodies.push_back(body);
  }
  return chain;
}

// Every third moving joint follows another one of the tree, forwards, backwards or, as 0, not at
// all.
inline arm::Chain WithMimics(arm::Chain chain, unsigned seed) {
  RandomStates random(seed);
  std::vector<std::size_t> free, following;
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    if (!chain.bodies[i].moves) continue;
    ((free.size() + following.size()) % 3 == 1 ? following : free).push_back(i);
  }
  for (const std::size_t i : following) {
    const std::size_t of = free[random.Index(free.size())];
    chain.bodies[i].mimic = arm::Mimic{.joint_name = chain.bodies[of].joint_name,
                                       .multiplier = i % 7 == 0 ? 0.0 : random.Uniform(-2.0, 2.0),
                                       .offset = random.Uniform(-1.0, 1.0)};
  }
  return chain;
}

}  // namespace sinew::world
