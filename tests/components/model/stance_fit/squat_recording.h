// robots/biped in the simulated world: squats under PD control with static torques fed forward,
// with a payload or friction that the model does not declare; and what its sensors record.
#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/floating_world/floating_world.h"
#include "components/bodies/dynamics/floating_dynamics.h"
#include "components/bodies/leg/geometry.h"
#include "components/bodies/leg/squat.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/bodies/links/fixed_links.h"
#include "components/model/actuator/model.h"
#include "components/model/stance_fit/stance_model.h"

namespace sinew::stance_fit {

inline arm::Chain ReadRobot() {
  std::ifstream stream(SINEW_SOURCE_DIR "/robots/biped/biped.urdf");
  std::ostringstream text;
  text << stream.rdbuf();
  return arm::ParseUrdf(text.str(), "biped.urdf");
}

inline std::vector<std::string> DrivenJoints(const arm::Chain& chain) {
  std::vector<std::string> out;
  for (const arm::Body& body : chain.bodies) {
    if (arm::IsDriven(body)) out.push_back(body.joint_name);
  }
  return out;
}

// Every driven joint with an exactly known drive and nothing else.
inline actuator::RobotModel DeclaredRobot(const arm::Chain& chain) {
  actuator::RobotModel robot;
  robot.name = "biped";
  for (const std::string& name : DrivenJoints(chain)) {
    actuator::JointModel joint;
    joint.name = name;
    joint.terms.push_back(actuator::MakeTerm("drive_torque", joint.constants));
    joint.terms.back().linear[0].value = 1.0;
    joint.terms.back().linear[0].fixed = true;
    robot.joints.push_back(joint);
  }
  return robot;
}

// What the declared model does not know.
struct Undeclared {
  double payload_kg = 0.0;
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  // in the base's frame
  std::string friction_joint = {};
  double coulomb_Nm = 0.0, viscous_Nm_s_rad = 0.0;
};

struct SquatPlan {
  int cycles = 4;
  double period_s = 3.0;
  double top_m = 0.06, bottom_m = 0.26;  // below the straight legs
  double settle_s = 1.0;                 // before the squats, not recorded
};

// Truth at the rate of the log, 200 Hz.
struct Motion {
  static constexpr double kPeriod_s = 5e-3;
  std::vector<std::string> joints;
  std::vector<Eigen::VectorXd> position_rad, torque_Nm;  // of the driven joints
  std::vector<std::array<double, 8>> force_N;
  std::vector<Eigen::Quaterniond> orientation;
  std::vector<Eigen::Vector3d> angular_velocity_rad_s;
};

// Substeps of a tick of 1 ms: 0.7 over the fastest rate of contacts (world::kFloatingSubstep_s).
inline constexpr int kSubsteps = 4;
inline constexpr double kSubstep_s = 1e-3 / kSubsteps;

// Throws std::runtime_error when the robot falls.
inline Motion Squat(const Undeclared& undeclared, const SquatPlan& plan) {
  const arm::Chain urdf = ReadRobot();
  const arm::MergedChain links = arm::MergeFixedLinks(urdf);
  const arm::Chain& nominal = links.chain;
  world::FloatingWorldConfig config;
  config.chain = nominal;
  config.substep_s = kSubstep_s;
  if (undeclared.payload_kg > 0.0) {
    arm::AddPointMass(undeclared.payload_kg, undeclared.place_m, &config.chain.base);
  }
  for (const char* side : {"right", "left"}) {
    for (const char* place : {"rear_outer", "rear_inner", "front_outer", "front_inner"}) {
      const std::string name = std::string(side) + "_force_" + place;
      const arm::LinkFrame* frame = arm::FindLink(links, name);
      if (frame == nullptr) throw std::runtime_error("no link " + name);
      config.contacts.push_back({name, frame->body, frame->body_from_link.translation()});
    }
  }
  Motion out;
  out.joints = DrivenJoints(urdf);
  std::vector<int> driven;
  const auto count = static_cast<Eigen::Index>(nominal.bodies.size());
  for (Eigen::Index j = 0; j < count; ++j) {
    const std::optional<arm::Passive>& toe = nominal.bodies[static_cast<std::size_t>(j)].passive;
    if (!toe) {
      driven.push_back(static_cast<int>(j));
      continue;
    }
    config.elastic_joints.push_back(
        {static_cast<int>(j), toe->stiffness_Nm_rad, toe->damping_Nms_rad, 0.0});
  }
  Eigen::VectorXd has_drive = Eigen::VectorXd::Ones(count);
  for (const world::ElasticJoint& toe : config.elastic_joints) has_drive[toe.joint] = 0.0;
  const int rubs = arm::FindJoint(nominal, undeclared.friction_joint);
  const leg::LegGeometry geometry = leg::GeometryOf(urdf, leg::NamesOfSide("left"), "left_sole");
  double foot_forward_m = 0.0;  // of the ankles before the hips
  const auto reference = [&](double time_s) {
    const double straight_m = leg::StraightHeight(geometry, foot_forward_m);
    const double w = 2.0 * std::numbers::pi / plan.period_s;
    const double half = 0.5 * (plan.bottom_m - plan.top_m);
    const double phase = w * std::max(0.0, time_s);
    leg::HipHeight hip;
    hip.height_m = straight_m - plan.top_m - half * (1.0 - std::cos(phase));
    if (time_s > 0.0) {
      hip.velocity_m_s = -half * w * std::sin(phase);
      hip.acceleration_m_s2 = -half * w * w * std::cos(phase);
    }
    return leg::SquatAt(geometry, foot_forward_m, hip).value();
  };
  world::FloatingWorld world(config);
  world::FloatingChain model(nominal);
  arm::FloatingDynamics dynamics(nominal);
  world::FloatingState state = world.chain().Rest();
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(count), wanted_rate = wanted;
  const auto pose = [&](const leg::SquatMotion& motion) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const std::string& name = nominal.bodies[static_cast<std::size_t>(j)].joint_name;
      const leg::JointMotion* joint = nullptr;
      if (name.find("hip_pitch") != std::string::npos) joint = &motion.hip_pitch;
      if (name.find("knee") != std::string::npos) joint = &motion.knee;
      if (name.find("ankle_pitch") != std::string::npos) joint = &motion.ankle_pitch;
      wanted[j] = joint != nullptr ? joint->position_rad : 0.0;
      wanted_rate[j] = joint != nullptr ? joint->velocity_rad_s : 0.0;
    }
  };
  // In the middle of the squat the centre of mass is this far before the ankles: behind it the
  // heels carry, before it the toes, which yield.
  constexpr double kCenterForward_m = -0.02;
  constexpr int kIterations = 5;  // the legs' part of the mass moves with the ankles, a third of it
  for (int k = 0; k < kIterations; ++k) {
    pose(reference(0.25 * plan.period_s));
    state.joint_position_rad = wanted;
    model.SetState(state);
    foot_forward_m = model.CenterOfMass().x() - kCenterForward_m;
  }
  pose(reference(0.0));
  state.joint_position_rad = wanted;
  model.SetState(state);
  double lowest = 1.0;
  for (const world::ContactPoint& contact : config.contacts) {
    lowest = std::min(lowest, model.Point(contact.body, contact.point_m).position_m.z());
  }
  state.position_m.z() = -lowest;
  world.Reset(state);
  // Half of the weight on each sole below the centre of mass.
  const auto static_torque = [&](const world::FloatingState& now) {
    arm::FloatingMotion still = dynamics.Rest();
    still.joint_position_rad = now.joint_position_rad;
    Eigen::VectorXd force(dynamics.freedom());
    dynamics.Force(still, dynamics.nominal(), force);
    world::FloatingState level = now;
    level.orientation.setIdentity();
    level.velocity.setZero();
    model.SetState(level);
    const Eigen::Vector3d center = model.CenterOfMass();
    Eigen::VectorXd torque = force.tail(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Isometry3d at = model.Pose(static_cast<int>(j));
      const Eigen::Vector3d axis = at.linear() * nominal.bodies[static_cast<std::size_t>(j)].axis;
      const double y =
          nominal.bodies[static_cast<std::size_t>(j)].joint_name[0] == 'l' ? 0.075 : -0.075;
      const Eigen::Vector3d sole(center.x(), center.y() + y, 0.0);
      const Eigen::Vector3d weight(0.0, 0.0, 0.5 * 9.81 * model.mass_kg());
      torque[j] -= axis.dot((sole - at.translation()).cross(weight));
    }
    return torque;
  };
  constexpr double kStiffness_Nm_rad = 400.0, kDamping_Nm_s_rad = 8.0;
  constexpr int kTicksPerRow = 5;  // 1 kHz control, 200 Hz log
  const int ticks = static_cast<int>(1000.0 * (plan.settle_s + plan.cycles * plan.period_s));
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(count);
  for (int tick = 0; tick < ticks; ++tick) {
    const double time_s = 1e-3 * tick - plan.settle_s;
    pose(reference(time_s));
    const world::FloatingState& now = world.state();
    if (tick % kTicksPerRow == 0 || tick == 0) torque = static_torque(now);
    Eigen::VectorXd command = torque + kStiffness_Nm_rad * (wanted - now.joint_position_rad) +
                              kDamping_Nm_s_rad * (wanted_rate - now.velocity.tail(count));
    command = command.cwiseProduct(has_drive);
    Eigen::VectorXd applied = command;
    for (int step = 0; step < kSubsteps; ++step) {
      if (rubs >= 0) {
        // Coulomb's law without its jump: a damper of 1.5 Nm / 0.05 rad/s on a foot of 0.01 kg m^2
        // has a rate of 3000 1/s, which the substep resolves.
        constexpr double kSliding_rad_s = 0.05;
        const double rate = world.state().velocity[world::kBaseFreedom + rubs];
        applied[rubs] = command[rubs] - undeclared.coulomb_Nm * std::tanh(rate / kSliding_rad_s) -
                        undeclared.viscous_Nm_s_rad * rate;
      }
      world.Step(applied);
    }
    constexpr double kUpright = 0.5;  // of the height of straight legs
    if (!(world.state().position_m.z() > kUpright * (geometry.thigh_m + geometry.shank_m))) {
      std::ostringstream message;
      message << "the robot fell at " << time_s << " s, ankles " << foot_forward_m
              << " m before the hips, last row: " << out.force_N.size();
      for (std::size_t k = 0; k < 8 && !out.force_N.empty(); ++k) {
        message << " " << out.force_N.back()[k];
      }
      throw std::runtime_error(message.str());
    }
    if (time_s < 0.0 || tick % kTicksPerRow != 0) continue;
    Eigen::VectorXd q(static_cast<Eigen::Index>(driven.size())), tau = q;
    for (std::size_t k = 0; k < driven.size(); ++k) {
      q[static_cast<Eigen::Index>(k)] = world.state().joint_position_rad[driven[k]];
      tau[static_cast<Eigen::Index>(k)] = command[driven[k]];
    }
    out.position_rad.push_back(q);
    out.torque_Nm.push_back(tau);
    out.force_N.emplace_back();
    for (std::size_t k = 0; k < 8; ++k) out.force_N.back()[k] = world.contact_forces()[k].normal_N;
    out.orientation.push_back(world.state().orientation);
    out.angular_velocity_rad_s.push_back(world.imu().angular_velocity_rad_s);
  }
  return out;
}

// Of the sensors, standard deviations of white noise but for the encoders, which round.
struct SensorNoise {
  double counts_per_turn = 16384.0;
  double torque_Nm = 0.05;
  double force_N = 2.0;
  double tilt_rad = 1e-3;
  double rate_rad_s = 3e-3;
};

inline StanceRecording Recorded(const Motion& motion, const std::string& name, unsigned seed,
                                const SensorNoise& noise = {}) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto rows = static_cast<Eigen::Index>(motion.position_rad.size());
  StanceRecording out;
  out.name = name;
  out.period_s = Motion::kPeriod_s;
  out.joints.resize(motion.joints.size());
  for (std::size_t j = 0; j < motion.joints.size(); ++j) {
    types::Run& run = out.joints[j];
    run.name = name;
    run.time_s.resize(rows);
    Eigen::VectorXd q(rows), tau(rows);
    const double count = 2.0 * std::numbers::pi / noise.counts_per_turn;
    for (Eigen::Index i = 0; i < rows; ++i) {
      const auto k = static_cast<std::size_t>(i);
      run.time_s[i] = Motion::kPeriod_s * static_cast<double>(i);
      q[i] = count * std::round(motion.position_rad[k][static_cast<Eigen::Index>(j)] / count);
      tau[i] = motion.torque_Nm[k][static_cast<Eigen::Index>(j)] + noise.torque_Nm * normal(random);
    }
    run.signals[types::Signal::kPosition] = q;
    run.signals[types::Signal::kTorque] = tau;
  }
  out.foot_force_N.resize(rows, 8);
  out.orientation_wxyz.resize(rows, 4);
  out.angular_velocity_rad_s.resize(rows, 3);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (Eigen::Index s = 0; s < 8; ++s) {
      out.foot_force_N(i, s) =
          motion.force_N[k][static_cast<std::size_t>(s)] + noise.force_N * normal(random);
    }
    Eigen::Vector3d tilt;
    for (double& part : tilt) part = noise.tilt_rad * normal(random);
    const double angle = tilt.norm();
    Eigen::Quaterniond off = Eigen::Quaterniond::Identity();
    if (angle > 0.0) off = Eigen::AngleAxisd(angle, tilt / angle);
    const Eigen::Quaterniond read = off * motion.orientation[k];
    out.orientation_wxyz.row(i) << read.w(), read.x(), read.y(), read.z();
    for (Eigen::Index a = 0; a < 3; ++a) {
      out.angular_velocity_rad_s(i, a) =
          motion.angular_velocity_rad_s[k][a] + noise.rate_rad_s * normal(random);
    }
  }
  return out;
}

}  // namespace sinew::stance_fit
