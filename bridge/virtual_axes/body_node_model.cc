#include "bridge/virtual_axes/body_node_model.h"

#include <Eigen/Geometry>

namespace sinew::virtual_axes {
namespace {

constexpr int kImuTemperature_degC = 25;

Eigen::Quaterniond HousingInTorso(const BodyNodeConfig& config) {
  const auto& rpy = config.mounting_rpy_rad;
  return Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX());
}

std::array<double, 3> InHousing(const Eigen::Quaterniond& q_BS, const std::array<double, 3>& v_B) {
  const Eigen::Vector3d v_S = q_BS.conjugate() * Eigen::Vector3d(v_B[0], v_B[1], v_B[2]);
  return {v_S.x(), v_S.y(), v_S.z()};
}

}  // namespace

BodyNodeModel::BodyNodeModel(const BodyNodeConfig& config, std::uint64_t seed)
    : config_(config), heartbeat_(config.heartbeat_ms), samples_(config.sample_ms) {
  std::seed_seq of_node{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(config.bus),
                        static_cast<std::uint32_t>(config.node)};
  random_.seed(of_node);
}

void BodyNodeModel::Start(std::int64_t now_ns, std::int64_t spread_ns) {
  started_ns_ = now_ns;
  heartbeat_.Start(now_ns, spread_ns);
  samples_.Start(now_ns, spread_ns);
}

DueFrames<BodyNodeModel::kCyclicMessages> BodyNodeModel::Due(const provider::BodySensors* body,
                                                             std::int64_t now_ns) {
  // Schedules go on while nothing is sent.
  const bool heartbeat_due = heartbeat_.IsDue(now_ns);
  const bool sample_due = samples_.IsDue(now_ns);
  const double time_s = 1e-9 * static_cast<double>(now_ns - started_ns_);
  const bool false_now = time_s >= config_.fault.after_s;
  DueFrames<kCyclicMessages> due;
  if (false_now && config_.fault.kind == BodyFaultKind::kLost) return due;
  if (heartbeat_due) {
    const auto uptime_ms = static_cast<std::uint32_t>((now_ns - started_ns_) / kMs_ns);
    due.Add(can::Encode(config_.node, can::NodeHeartbeat{uptime_ms, 0}));
  }
  if (!sample_due) return due;
  const bool is_imu = config_.part == can::BodyPart::kImu;
  if (!(false_now && config_.fault.kind == BodyFaultKind::kFrozen)) {
    ++sequence_;
    const provider::BodySensors nothing;
    if (is_imu) {
      MeasureImu(body != nullptr ? *body : nothing);
    } else {
      MeasureFoot(body != nullptr ? *body : nothing);
    }
  }
  if (is_imu) {
    due.Add(can::Encode(config_.node, force_));
    due.Add(can::Encode(config_.node, rate_));
    due.Add(can::Encode(config_.node, orientation_));
  } else {
    due.Add(can::Encode(config_.node, foot_));
  }
  return due;
}

void BodyNodeModel::MeasureFoot(const provider::BodySensors& body) {
  const std::size_t first =
      config_.part == can::BodyPart::kRightFoot ? 0 : std::size_t{can::kFootSensors};
  foot_.sequence = sequence_;
  for (std::size_t i = 0; i < std::size_t{can::kFootSensors}; ++i) {
    foot_.force_N[i] = body.foot_force_N[first + i];
    foot_.valid[i] = body.foot_valid[first + i];
  }
}

void BodyNodeModel::MeasureImu(const provider::BodySensors& body) {
  const Eigen::Quaterniond q_BS = HousingInTorso(config_);
  const auto& o = body.orientation_wxyz;
  const Eigen::Quaterniond q_WS = Eigen::Quaterniond(o[0], o[1], o[2], o[3]) * q_BS;
  const auto orientation = can::OmitLargest({q_WS.w(), q_WS.x(), q_WS.y(), q_WS.z()}, sequence_);
  force_ = {Noisy(InHousing(q_BS, body.acceleration_m_s2), config_.force_noise_m_s2), sequence_,
            body.imu_valid, body.imu_valid, body.imu_valid && orientation.has_value()};
  rate_ = {Noisy(InHousing(q_BS, body.angular_velocity_rad_s), config_.rate_noise_rad_s), sequence_,
           kImuTemperature_degC};
  orientation_ = orientation.value_or(can::ImuOrientation{{}, sequence_, 0});
}

std::array<double, 3> BodyNodeModel::Noisy(std::array<double, 3> values,
                                           double standard_deviation) {
  if (standard_deviation > 0.0) {
    for (double& value : values) value += standard_deviation * gaussian_(random_);
  }
  return values;
}

}  // namespace sinew::virtual_axes
