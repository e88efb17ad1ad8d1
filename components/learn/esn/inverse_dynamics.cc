#include "components/learn/esn/inverse_dynamics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/joints.h"
#include "components/base/types/require.h"
#include "components/base/types/state_archive.h"

namespace sinew::esn {
namespace {

constexpr const char* kRigidTerm = "rigid_body";
// Terms of one joint on a fixed base that the bodies of the URDF hold already.
constexpr const char* kPartOfBodies[] = {"link_inertia",  "inertia", "gravity",
                                         "gravity_phase", "payload", "declared_payload"};

double Or(double value, double fallback) { return std::isfinite(value) ? value : fallback; }

double TorqueAt(const actuator::JointModel& model, effects::JointSample sample,
                double velocity_rad_s, const std::vector<double>& memory) noexcept {
  sample.velocity_rad_s = velocity_rad_s;
  sample.motor_velocity_rad_s = velocity_rad_s * model.constants.gear_ratio;
  return model.RequiredDriveTorque(sample, memory);
}

double SmoothTorque(const actuator::JointModel& model, const effects::JointSample& x,
                    double smoothing_rad_s, const std::vector<double>& memory) noexcept {
  const double share = x.velocity_rad_s / smoothing_rad_s;
  if (std::abs(share) >= 1.0) return TorqueAt(model, x, x.velocity_rad_s, memory);
  return 0.5 * ((1.0 - share) * TorqueAt(model, x, -smoothing_rad_s, memory) +
                (1.0 + share) * TorqueAt(model, x, smoothing_rad_s, memory));
}

}  // namespace

bool InverseDynamics::Motion::finite() const noexcept {
  return std::isfinite(q) && std::isfinite(v) && std::isfinite(a);
}

InverseDynamics::InverseDynamics(const InverseDynamicsConfig& config)
    : smoothing_rad_s_(config.smoothing_rad_s),
      state_(config.state),
      proportional_1_s2_(config.proportional_1_s2),
      derivative_1_s_(config.derivative_1_s) {
  const actuator::RobotModel& robot = config.robot;
  if (robot.joints.empty() || robot.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument("model " + robot.name + ": " + std::to_string(robot.joints.size()) +
                                " joints, expected 1 .. " + std::to_string(types::kMaxJoints));
  }
  types::Require(smoothing_rad_s_ > 0.0, "smoothing_rad_s", smoothing_rad_s_, "above 0");
  types::Require(proportional_1_s2_ >= 0.0, "proportional_1_s2", proportional_1_s2_, "0 or more");
  types::Require(derivative_1_s_ >= 0.0, "derivative_1_s", derivative_1_s_, "0 or more");
  for (const actuator::JointModel& model : robot.joints) joints_.emplace_back().model = model;
  if (config.stance) AddStance(*config.stance);
  for (Joint& joint : joints_) {
    joint.memory.resize(static_cast<std::size_t>(joint.model.memory_size()));
  }
}

void InverseDynamics::AddStance(const StanceConfig& config) {
  CheckDriven(config.chain);
  stance_.emplace(config.chain, config.soles);
  q_ = v_ = a_ = Eigen::VectorXd::Zero(stance_->joints());
  const std::vector<std::string>& names = stance_->dynamics().joint_names();
  for (Joint& joint : joints_) {
    const auto found = std::find(names.begin(), names.end(), joint.model.name);
    if (found == names.end()) {
      throw std::invalid_argument("joint '" + joint.model.name + "' is none of robot '" +
                                  config.chain.name + "'");
    }
    joint.of_robot = found - names.begin();
    for (const char* term : kPartOfBodies) {
      if (joint.model.Find(term) < 0) continue;
      throw std::invalid_argument("joint '" + joint.model.name + "': the term '" + term +
                                  "' is part of the bodies of robot '" + config.chain.name + "'");
    }
    if (joint.model.Find(kRigidTerm) < 0) {
      joint.model.terms.push_back(actuator::MakeTerm(kRigidTerm, joint.model.constants));
    }
  }
}

void InverseDynamics::CheckDriven(const arm::Chain& chain) const {
  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsDriven(body)) continue;
    const bool named = std::any_of(joints_.begin(), joints_.end(), [&body](const Joint& joint) {
      return joint.model.name == body.joint_name;
    });
    if (named) continue;
    throw std::invalid_argument("joint '" + body.joint_name + "' of robot '" + chain.name +
                                "' is driven, expected it in the model");
  }
}

void InverseDynamics::Reset() noexcept {
  for (Joint& joint : joints_) joint.started = false;
}

InverseDynamics::Motion InverseDynamics::MotionOf(const Frame& frame, int joint) const noexcept {
  Motion motion{frame.Get({Signal::kReferencePosition, joint}),
                frame.Get({Signal::kReferenceVelocity, joint}),
                frame.Get({Signal::kReferenceAcceleration, joint})};
  const double position_rad = frame.Get({Signal::kPosition, joint});
  const double velocity_rad_s = frame.Get({Signal::kVelocity, joint});
  // Not read without a gain: a lost measurement must not make a number of the reference none.
  if (proportional_1_s2_ > 0.0) motion.a += proportional_1_s2_ * (motion.q - position_rad);
  if (derivative_1_s_ > 0.0) motion.a += derivative_1_s_ * (motion.v - velocity_rad_s);
  if (state_ == MotionState::kMeasured) {
    motion.q = position_rad;
    motion.v = velocity_rad_s;
  }
  return motion;
}

bool InverseDynamics::SolveStance(const Frame& frame) noexcept {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Motion motion = MotionOf(frame, static_cast<int>(j));
    q_[joints_[j].of_robot] = motion.q;
    v_[joints_[j].of_robot] = motion.v;
    a_[joints_[j].of_robot] = motion.a;
  }
  return stance_->Solve(q_, v_, a_).ok;
}

Prediction InverseDynamics::Step(const Frame& frame, double period_s) noexcept {
  Prediction prediction;
  prediction.joint_count = joint_count();
  if (stance_ && !SolveStance(frame)) return prediction;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const int index = static_cast<int>(j);
    const Motion motion = MotionOf(frame, index);
    if (!motion.finite()) continue;
    effects::JointSample x;
    x.position_rad = motion.q;
    x.velocity_rad_s = motion.v;
    x.acceleration_rad_s2 = motion.a;
    x.motor_position_rad = x.position_rad * joint.model.constants.gear_ratio;
    x.motor_velocity_rad_s = x.velocity_rad_s * joint.model.constants.gear_ratio;
    x.motor_acceleration_rad_s2 = x.acceleration_rad_s2 * joint.model.constants.gear_ratio;
    x.pressure_bar = Or(frame.Get({Signal::kChamberPressure, index}), 0.0);
    x.load_force_N = Or(frame.Get({Signal::kLoadForce, index}), 0.0);
    x.payload_kg = Or(frame.Get({Signal::kPayload, index}), 0.0);
    x.temperature_degC = Or(frame.Get({Signal::kTemperature, index}), 25.0);
    if (stance_) x.rigid_torque_Nm = stance_->result().torque[joint.of_robot];
    if (!joint.started) {
      joint.model.ResetMemory(x, joint.memory);
      joint.started = true;
    } else {
      joint.model.Advance(x, period_s, joint.memory);
    }
    const double torque_Nm = SmoothTorque(joint.model, x, smoothing_rad_s_, joint.memory);
    if (!std::isfinite(torque_Nm)) continue;
    prediction.torque_Nm[j] = torque_Nm;
    prediction.sea_torque_Nm[j] = torque_Nm;
    prediction.pea_torque_Nm[j] = torque_Nm;
    prediction.valid[j] = true;
  }
  return prediction;
}

void InverseDynamics::Joint::Exchange(types::StateArchive& archive) { archive(memory, started); }

void InverseDynamics::Exchange(types::StateArchive& archive) { archive(joints_, q_, v_, a_); }

}  // namespace sinew::esn
