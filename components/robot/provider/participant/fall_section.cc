#include "components/robot/provider/participant/fall_section.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/bodies/leg/geometry.h"
#include "components/bodies/links/file/urdf_file.h"

namespace sinew::provider {

namespace {

const arm::Body& BodyOf(const arm::Chain& chain, int index) {
  return chain.bodies[static_cast<std::size_t>(index)];
}

std::vector<std::string> DrivenJoints(const arm::Chain& chain) {
  std::vector<std::string> names;
  for (const arm::Body& body : chain.bodies) {
    if (arm::IsDriven(body)) names.push_back(body.joint_name);
  }
  return names;
}

GuardedLeg ReadLeg(const config::Section& fall, const arm::Chain& chain,
                   const std::vector<std::string>& driven, const std::string& side) {
  const leg::LegJointNames names = leg::NamesOfSide(side);
  GuardedLeg guarded;
  try {
    guarded.geometry = leg::GeometryOf(chain, names, side + "_sole");
  } catch (const std::invalid_argument& error) {
    fall.Fail("urdf", error.what());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = std::find(driven.begin(), driven.end(), names[i]);
    if (found == driven.end()) {
      fall.Fail("urdf", "joint '" + names[i] + "' has no effort above 0: it is not driven");
    }
    guarded.joint[i] = static_cast<int>(found - driven.begin());
  }
  return guarded;
}

Eigen::Matrix3d ReadImuMounting(const config::Section& fall, const arm::Chain& chain) {
  const auto found = std::find_if(chain.bodies.begin(), chain.bodies.end(),
                                  [](const arm::Body& body) { return body.link_name == "imu"; });
  if (found == chain.bodies.end()) fall.Fail("urdf", "has no link 'imu'");
  Eigen::Matrix3d base_from_imu = Eigen::Matrix3d::Identity();
  for (auto body = static_cast<int>(found - chain.bodies.begin()); body >= 0;
       body = BodyOf(chain, body).parent) {
    if (BodyOf(chain, body).moves) fall.Fail("urdf", "link 'imu' is not fixed to the base");
    base_from_imu = BodyOf(chain, body).parent_from_joint.linear() * base_from_imu;
  }
  return base_from_imu.transpose();
}

fall::ImuBounds ReadImuBounds(const config::Section& imu) {
  fall::ImuBounds bounds;
  const auto read = [&imu](const char* key, double* value) {
    *value = imu.NumberOr(key, *value, config::kNotNegative);
  };
  read("force_range_m_s2", &bounds.force_range_m_s2);
  read("force_bias_m_s2", &bounds.force_bias_m_s2);
  read("force_noise_m_s2", &bounds.force_noise_m_s2);
  read("rate_range_rad_s", &bounds.rate_range_rad_s);
  read("rate_bias_rad_s", &bounds.rate_bias_rad_s);
  read("rate_drift_rad_s2", &bounds.rate_drift_rad_s2);
  read("rate_noise_rad_s", &bounds.rate_noise_rad_s);
  read("rate_scale_error", &bounds.rate_scale_error);
  return bounds;
}

}  // namespace

FallGuardConfig ReadFallGuard(const config::Section& fall) {
  const std::filesystem::path urdf = fall.ExistingPath("urdf");
  const arm::Chain chain = arm::ParseUrdf(config::ReadFile(urdf), urdf.string());
  const std::vector<std::string> driven = DrivenJoints(chain);
  FallGuardConfig config;
  config.joint_count = static_cast<int>(driven.size());
  config.right = ReadLeg(fall, chain, driven, "right");
  config.left = ReadLeg(fall, chain, driven, "left");
  config.imu_from_base = ReadImuMounting(fall, chain);
  config.start_within_s = fall.NumberOr("start_within_s", config.start_within_s, config::kPositive);
  fall::FallConfig& detector = config.detector;
  detector.mass_kg = chain.base.mass_kg;
  for (const arm::Body& body : chain.bodies) detector.mass_kg += body.mass_kg;
  detector.tilt.pendulum_length_m =
      fall.NumberOr("pendulum_length_m", detector.tilt.pendulum_length_m, config::kPositive);
  detector.tilt.imu = ReadImuBounds(fall.ChildOrEmpty("imu"));
  return config;
}

}  // namespace sinew::provider
