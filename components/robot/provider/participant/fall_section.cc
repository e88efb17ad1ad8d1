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

}  // namespace

static void Describe(config::Fields& f, fall::ImuBounds& c) {
  using config::kNotNegative;
  f("force_range_m_s2", c.force_range_m_s2, kNotNegative, "largest reading");
  f("force_bias_m_s2", c.force_bias_m_s2, kNotNegative, "horizontal part");
  f("force_noise_m_s2", c.force_noise_m_s2, kNotNegative, "standard deviation per axis");
  f("rate_range_rad_s", c.rate_range_rad_s, kNotNegative, "largest reading");
  f("rate_bias_rad_s", c.rate_bias_rad_s, kNotNegative, "when switched on");
  f("rate_drift_rad_s2", c.rate_drift_rad_s2, kNotNegative, "of the bias");
  f("rate_noise_rad_s", c.rate_noise_rad_s, kNotNegative, "standard deviation per axis");
  f("rate_scale_error", c.rate_scale_error, kNotNegative, "share of the reading");
}

void Describe(config::Fields& f, FallGuardConfig& c) {
  std::filesystem::path urdf;
  fall::FallConfig& detector = c.detector;
  f.Need("urdf", urdf,
         "legs, mass, mounting of the link imu; joints: its driven ones, in its order");
  f("start_within_s", c.start_within_s, config::kPositive,
    "an armed robot whose detector has not started by then has a fault");
  f("pendulum_length_m", detector.tilt.pendulum_length_m, config::kPositive,
    "foot to highest mass");
  f.Object("imu", "bounds of the robot's part (components/robot/fall/imu_check.h)",
           [&](config::Fields& imu) { Describe(imu, detector.tilt.imu); });
  if (!f.reads()) return;
  const arm::Chain chain = arm::ParseUrdf(config::ReadFile(urdf), urdf.string());
  const std::vector<std::string> driven = DrivenJoints(chain);
  c.joint_count = static_cast<int>(driven.size());
  c.right = ReadLeg(f.section(), chain, driven, "right");
  c.left = ReadLeg(f.section(), chain, driven, "left");
  c.imu_from_base = ReadImuMounting(f.section(), chain);
  detector.mass_kg = chain.base.mass_kg;
  for (const arm::Body& body : chain.bodies) detector.mass_kg += body.mass_kg;
}

}  // namespace sinew::provider
