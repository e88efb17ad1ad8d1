#include "components/robot/provider/fall_guard.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "components/base/types/angle.h"

namespace sinew::provider {

namespace {

constexpr double kRotation = 1e-6;  // as leg::Inverse's

void RequireJoints(const GuardedLeg& leg, int joint_count) {
  for (const int joint : leg.joint) {
    if (joint >= 0 && joint < std::min(joint_count, types::kMaxJoints)) continue;
    throw std::invalid_argument("joint " + std::to_string(joint) + " of a leg, expected one of " +
                                std::to_string(joint_count) + " joints");
  }
}

// Height of the base above the sole, along the sole's normal.
double HeightOverSole(const Eigen::Isometry3d& base_from_sole) noexcept {
  return -base_from_sole.linear().col(2).dot(base_from_sole.translation());
}

}  // namespace

FallGuard::FallGuard(const FallGuardConfig& config, double period_s)
    : config_(config), period_s_(period_s), detector_(config.detector, period_s) {
  RequireJoints(config.right, config.joint_count);
  RequireJoints(config.left, config.joint_count);
  const Eigen::Matrix3d& r = config.imu_from_base;
  const double error = (r * r.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (!(error <= kRotation) || !(r.determinant() > 0.0)) {
    throw std::invalid_argument("the IMU's mounting is no rotation");
  }
  if (!std::isfinite(config.start_within_s) || config.start_within_s <= 0.0) {
    throw std::invalid_argument("start_within_s is positive, got " +
                                std::to_string(config.start_within_s));
  }
}

void FallGuard::Reset() noexcept {
  detector_.Reset();
  output_ = {};
  asking_ = false;
  unwatched_s_ = 0.0;
  fallen_ = false;
  message_size_ = 0;
}

void FallGuard::TakeAsked(const PlantSensors& sensors, types::RobotState state,
                          const PlantCommand* asked) noexcept {
  const bool may_move = types::MayMove(state);
  if (may_move && !asking_) asked_rad_ = sensors.position_rad;
  asking_ = may_move;
  if (!asking_ || asked == nullptr) return;
  for (std::size_t j = 0; j < asked_rad_.size(); ++j) {
    if (asked->mode[j] != types::ControlMode::kIdle) asked_rad_[j] = asked->position_rad[j];
  }
}

leg::LegAngles FallGuard::AnglesOf(const GuardedLeg& leg,
                                   const types::JointArray<double>& position_rad) const noexcept {
  leg::LegAngles angles;
  for (std::size_t i = 0; i < leg.joint.size(); ++i) {
    angles[static_cast<Eigen::Index>(i)] = position_rad[static_cast<std::size_t>(leg.joint[i])];
  }
  return angles;
}

bool FallGuard::Step(std::uint64_t tick, const PlantSensors& sensors, const BodySensors& body,
                     types::RobotState state, const PlantCommand* asked) noexcept {
  TakeAsked(sensors, state, asked);
  fall::FallInput input;
  input.tick = tick;
  input.imu.valid = body.imu_valid;
  input.imu.force_m_s2 = Eigen::Map<const Eigen::Vector3d>(body.acceleration_m_s2.data());
  input.imu.rate_rad_s = Eigen::Map<const Eigen::Vector3d>(body.angular_velocity_rad_s.data());
  input.feet.force_N = body.foot_force_N;
  input.feet.valid = body.foot_valid;
  const fall::FootLoads loads = fall::LoadsOf(input.feet);
  if (loads.total_N() > 0.0) right_carries_ = loads.right_carries_more();
  const GuardedLeg& leg = right_carries_ ? config_.right : config_.left;

  const bool measured = std::all_of(leg.joint.begin(), leg.joint.end(), [&](int joint) {
    const auto j = static_cast<std::size_t>(joint);
    return sensors.valid[j] && std::isfinite(sensors.position_rad[j]);
  });
  if (measured) {
    const Eigen::Isometry3d sole = leg::Forward(leg.geometry, AnglesOf(leg, sensors.position_rad));
    input.foot_to_base_m = -(config_.imu_from_base * sole.translation());
  }
  if (asking_) {
    input.reference_height_m =
        HeightOverSole(leg::Forward(leg.geometry, AnglesOf(leg, asked_rad_)));
  } else if (measured) {
    input.reference_height_m = detector_.filter().up().dot(input.foot_to_base_m);
  }
  reference_height_m_ = input.reference_height_m;

  output_ = detector_.Step(input);
  const bool starts = output_.unknown == fall::Unknown::kStarting;
  unwatched_s_ = asking_ && starts ? unwatched_s_ + period_s_ : 0.0;
  if (fallen_) return false;
  Find();
  return fallen_;
}

template <class... Values>
void FallGuard::Write(const char* format, Values... values) noexcept {
  const int size = std::snprintf(message_.data(), message_.size(), format, values...);
  message_size_ =
      static_cast<std::size_t>(std::clamp(size, 0, static_cast<int>(message_.size()) - 1));
  fallen_ = true;
}

void FallGuard::Find() noexcept {
  const std::string_view lost = fall::UnknownName(output_.unknown);
  switch (output_.state) {
    case fall::FallState::kUpright:
      return;
    case fall::FallState::kUnknown:
      if (output_.unknown != fall::Unknown::kStarting) {
        Write("fall: not known, lost: %.*s", static_cast<int>(lost.size()), lost.data());
      } else if (unwatched_s_ > config_.start_within_s) {
        Write("fall: not known, the detector has not started within %.3g s",
              config_.start_within_s);
      }
      return;
    case fall::FallState::kFalling:
      break;
  }
  switch (output_.criterion) {
    case fall::Criterion::kTilt:
      Write("fall: tilt %.1f deg, limit %.1f deg", output_.tilt_rad / types::kDegree_rad,
            detector_.tilt_threshold_rad() / types::kDegree_rad);
      break;
    case fall::Criterion::kBaseHeight:
      Write("fall: base_height %.3f m, asked %.3f m", output_.base_height_m, reference_height_m_);
      break;
    case fall::Criterion::kFreeFall:
      Write("fall: free_fall, feet %.0f N of %.0f N", output_.feet.total_N(),
            config_.detector.mass_kg * types::kGravity_m_s2);
      break;
    case fall::Criterion::kNone:
      Write("%s", "fall");
      break;
  }
}

std::string FallGuard::ArmRefusal() const {
  if (fallen_) return std::string(message()) + "; set the robot up, then reset";
  if (upright()) return "";
  return "the fall detector has not started: stand still, with IMU, feet and legs measured";
}

}  // namespace sinew::provider
