#include "components/esn/inverse_dynamics.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "components/types/joints.h"

namespace sinew::esn {
namespace {

double Or(double value, double fallback) { return std::isfinite(value) ? value : fallback; }

double TorqueAt(const actuator::JointModel& model, effects::JointSample sample,
                double velocity_rad_s, const std::vector<double>& memory) noexcept {
  sample.velocity_rad_s = velocity_rad_s;
  sample.motor_velocity_rad_s = velocity_rad_s * model.constants.gear_ratio;
  return model.RequiredDriveTorque(sample, memory);
}

}  // namespace

InverseDynamics::InverseDynamics(const actuator::RobotModel& robot, double smoothing_rad_s)
    : smoothing_rad_s_(smoothing_rad_s) {
  if (robot.joints.empty() || robot.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument("model " + robot.name + ": " + std::to_string(robot.joints.size()) +
                                " joints, expected 1 .. " + std::to_string(types::kMaxJoints));
  }
  if (!(smoothing_rad_s > 0.0) || !std::isfinite(smoothing_rad_s)) {
    throw std::invalid_argument("smoothing_rad_s: " + std::to_string(smoothing_rad_s) +
                                ", expected above 0");
  }
  for (const actuator::JointModel& model : robot.joints) {
    joints_.push_back({model, std::vector<double>(static_cast<std::size_t>(model.memory_size()))});
  }
}

void InverseDynamics::Reset() noexcept {
  for (Joint& joint : joints_) joint.started = false;
}

Prediction InverseDynamics::Step(const Frame& frame, double period_s) noexcept {
  Prediction prediction;
  prediction.joint_count = joint_count();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const int index = static_cast<int>(j);
    effects::JointSample x;
    x.position_rad = frame.Get({Signal::kReferencePosition, index});
    x.velocity_rad_s = frame.Get({Signal::kReferenceVelocity, index});
    x.acceleration_rad_s2 = frame.Get({Signal::kReferenceAcceleration, index});
    if (!std::isfinite(x.position_rad) || !std::isfinite(x.velocity_rad_s) ||
        !std::isfinite(x.acceleration_rad_s2)) {
      continue;
    }
    x.motor_position_rad = x.position_rad * joint.model.constants.gear_ratio;
    x.motor_velocity_rad_s = x.velocity_rad_s * joint.model.constants.gear_ratio;
    x.motor_acceleration_rad_s2 = x.acceleration_rad_s2 * joint.model.constants.gear_ratio;
    x.pressure_bar = Or(frame.Get({Signal::kChamberPressure, index}), 0.0);
    x.load_force_N = Or(frame.Get({Signal::kLoadForce, index}), 0.0);
    x.payload_kg = Or(frame.Get({Signal::kPayload, index}), 0.0);
    x.temperature_degC = Or(frame.Get({Signal::kTemperature, index}), 25.0);
    if (!joint.started) {
      joint.model.ResetMemory(x, joint.memory);
      joint.started = true;
    } else {
      joint.model.Advance(x, period_s, joint.memory);
    }
    double torque_Nm = 0.0;
    const double share = x.velocity_rad_s / smoothing_rad_s_;
    if (std::abs(share) < 1.0) {
      torque_Nm = 0.5 * ((1.0 - share) * TorqueAt(joint.model, x, -smoothing_rad_s_, joint.memory) +
                         (1.0 + share) * TorqueAt(joint.model, x, smoothing_rad_s_, joint.memory));
    } else {
      torque_Nm = TorqueAt(joint.model, x, x.velocity_rad_s, joint.memory);
    }
    if (!std::isfinite(torque_Nm)) continue;
    prediction.torque_Nm[j] = torque_Nm;
    prediction.sea_torque_Nm[j] = torque_Nm;
    prediction.pea_torque_Nm[j] = torque_Nm;
    prediction.valid[j] = true;
  }
  return prediction;
}

}  // namespace sinew::esn
