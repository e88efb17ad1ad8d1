#include "bridge/joints/body_measurement.h"

#include <Eigen/Geometry>

namespace sinew::bridge {
namespace {

using Vector = Eigen::Map<const Eigen::Vector3d>;

Eigen::Quaterniond MountingOf(const BodyNodeConfig& config) {
  const auto& rpy = config.mounting_rpy_rad;
  return Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX());
}

std::array<double, 3> Rotated(const Eigen::Quaterniond& q, const std::array<double, 3>& v) {
  const Eigen::Vector3d rotated = q * Vector(v.data());
  return {rotated.x(), rotated.y(), rotated.z()};
}

}  // namespace

bool SampleClock::Take(std::uint8_t sequence, std::int64_t stamp_ns) {
  const auto step = static_cast<std::uint8_t>(sequence - sequence_);
  if (newest_ns_ && step == 0) return false;
  constexpr std::uint8_t kHalf = 128;
  if (newest_ns_ && step < kHalf) missed_ += step - 1U;
  sequence_ = sequence;
  newest_ns_ = stamp_ns;
  return true;
}

BodyMeasurement::BodyMeasurement(const BodyNodeConfig& config, const BridgeTiming& timing)
    : config_(config), timing_(timing) {}

void BodyMeasurement::Reset(std::int64_t now_ns) {
  clock_ = {};
  reset_ns_ = now_ns;
  lost_ = false;
  losses_ = 0;
  heartbeat_.reset();
  foot_ = {};
  coming_ = imu_ = {};
}

BodyMeasurement::Taken BodyMeasurement::Take(const can::Received& received) {
  if (static_cast<can::NodeCommand>(can::AddressOf(received.frame)->command) ==
      can::NodeCommand::kHeartbeat) {
    const auto heartbeat = can::DecodeNodeHeartbeat(received.frame);
    if (!heartbeat) return Taken::kMalformed;
    heartbeat_ = heartbeat;
    return Taken::kStored;
  }
  return config_.part == can::BodyPart::kImu ? TakeImu(received) : TakeFoot(received);
}

BodyMeasurement::Taken BodyMeasurement::TakeFoot(const can::Received& received) {
  if (static_cast<can::NodeCommand>(can::AddressOf(received.frame)->command) !=
      can::NodeCommand::kFootForces) {
    return Taken::kUnused;
  }
  const auto forces = can::DecodeFootForces(received.frame);
  if (!forces) return Taken::kMalformed;
  if (clock_.Take(forces->sequence, received.stamp_ns)) foot_ = *forces;
  return Taken::kStored;
}

BodyMeasurement::Taken BodyMeasurement::TakeImu(const can::Received& received) {
  switch (static_cast<can::NodeCommand>(can::AddressOf(received.frame)->command)) {
    case can::NodeCommand::kImuForce:
      if (const auto m = can::DecodeImuForce(received.frame)) {
        if (ImuSample* sample = Coming(m->sequence, received.stamp_ns)) {
          sample->force_m_s2 = m->specific_force_m_s2;
          sample->saturated = sample->saturated || can::AtFieldEnd(*m);
          sample->valid = m->force_valid && m->rate_valid && m->orientation_valid;
          Complete(kForce);
        }
        return Taken::kStored;
      }
      break;
    case can::NodeCommand::kImuRate:
      if (const auto m = can::DecodeImuRate(received.frame)) {
        if (ImuSample* sample = Coming(m->sequence, received.stamp_ns)) {
          sample->rate_rad_s = m->angular_velocity_rad_s;
          sample->saturated = sample->saturated || can::AtFieldEnd(*m);
          Complete(kRate);
        }
        return Taken::kStored;
      }
      break;
    case can::NodeCommand::kImuOrientation:
      if (const auto m = can::DecodeImuOrientation(received.frame)) {
        const auto orientation_wxyz = can::Restore(*m);
        if (!orientation_wxyz) break;
        if (ImuSample* sample = Coming(m->sequence, received.stamp_ns)) {
          sample->orientation_wxyz = *orientation_wxyz;
          Complete(kOrientation);
        }
        return Taken::kStored;
      }
      break;
    default:
      return Taken::kUnused;
  }
  return Taken::kMalformed;
}

BodyMeasurement::ImuSample* BodyMeasurement::Coming(std::uint8_t sequence, std::int64_t stamp_ns) {
  if (coming_.parts == 0 || coming_.sequence != sequence) {
    coming_ = {};
    coming_.sequence = sequence;
    coming_.stamp_ns = stamp_ns;
  }
  return coming_.parts == kWhole ? nullptr : &coming_;  // a whole one stands still
}

void BodyMeasurement::Complete(ImuPart part) {
  coming_.parts |= part;
  if (coming_.parts != kWhole || !clock_.Take(coming_.sequence, coming_.stamp_ns)) return;
  imu_ = coming_;
}

void BodyMeasurement::Fill(std::int64_t now_ns, provider::BodySensors* body) {
  const std::int64_t age_ns = now_ns - clock_.newest_ns().value_or(reset_ns_);
  const bool lost = age_ns > ToNs(timing_.lost_after_s);
  if (lost && !lost_) ++losses_;
  lost_ = lost;
  const bool fresh = clock_.newest_ns() && age_ns <= ToNs(timing_.estimate_timeout_s) &&
                     heartbeat_ && heartbeat_->version == can::kNodeFramesVersion;
  if (config_.part == can::BodyPart::kImu) {
    FillImu(fresh, body);
  } else {
    FillFoot(fresh, body);
  }
}

void BodyMeasurement::FillFoot(bool fresh, provider::BodySensors* body) const {
  const std::size_t first =
      config_.part == can::BodyPart::kRightFoot ? 0 : std::size_t{can::kFootSensors};
  for (std::size_t i = 0; i < std::size_t{can::kFootSensors}; ++i) {
    body->foot_force_N[first + i] = foot_.force_N[i];
    body->foot_valid[first + i] = fresh && foot_.valid[i] && !can::AtFieldEnd(foot_, i);
  }
}

void BodyMeasurement::FillImu(bool fresh, provider::BodySensors* body) const {
  body->imu_valid = fresh && imu_.valid && !imu_.saturated;
  if (!clock_.newest_ns()) return;  // nothing to turn: what is there stays
  const Eigen::Quaterniond q_BS = MountingOf(config_);
  const auto& o = imu_.orientation_wxyz;
  const Eigen::Quaterniond q_WB = Eigen::Quaterniond(o[0], o[1], o[2], o[3]) * q_BS.conjugate();
  body->acceleration_m_s2 = Rotated(q_BS, imu_.force_m_s2);
  body->angular_velocity_rad_s = Rotated(q_BS, imu_.rate_rad_s);
  body->orientation_wxyz = {q_WB.w(), q_WB.x(), q_WB.y(), q_WB.z()};
}

}  // namespace sinew::bridge
