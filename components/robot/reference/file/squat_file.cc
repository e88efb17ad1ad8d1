#include "components/robot/reference/file/squat_file.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "components/base/types/joints.h"
#include "components/bodies/leg/geometry.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/robot/reference/squat.h"

namespace sinew::reference {
namespace {

TrajectoryPtr ReadRepeatedSquats(const config::Section& s, int cycles) {
  SquatsConfig c;
  c.straight_margin_m = s.NumberOr("straight_margin_m", c.straight_margin_m, config::kPositive);
  c.depth_m = s.Number("depth_m", config::kPositive);
  c.period_s = s.NumberOr("period_s", c.period_s, config::kPositive);
  c.cycles = cycles;
  return MakeSquats(c);
}

TrajectoryPtr ReadChirpSquat(const config::Section& s, LoadedReference* loaded) {
  ChirpSquatConfig c;
  c.straight_margin_m = s.NumberOr("straight_margin_m", c.straight_margin_m, config::kPositive);
  c.depth_m = s.Number("depth_m", config::kPositive);
  c.acceleration_m_s2 = s.NumberOr("acceleration_m_s2", c.acceleration_m_s2, config::kPositive);
  c.shape.duration_s = s.NumberOr("duration_s", c.shape.duration_s, config::kPositive);
  c.shape.start_frequency_Hz =
      s.NumberOr("start_frequency_Hz", c.shape.start_frequency_Hz, config::kPositive);
  c.shape.end_frequency_Hz =
      s.NumberOr("end_frequency_Hz", c.shape.end_frequency_Hz, config::kPositive);
  const auto chirp = std::make_shared<ChirpSquat>(c);
  char note[192];
  std::snprintf(note, sizeof(note),
                "squat: amplitude %.4g m, drawn in to %.4g m at the end to keep %.4g m/s2",
                0.5 * (c.depth_m - c.straight_margin_m), chirp->end_amplitude_m(),
                c.acceleration_m_s2);
  loaded->notes.emplace_back(note);
  return chirp;
}

TrajectoryPtr ReadBaseHeight(const config::Section& s, LoadedReference* loaded) {
  const std::string kind = s.Choice("kind", {"benchmark", "six", "chirp"});
  try {
    if (kind == "chirp") return ReadChirpSquat(s, loaded);
    return ReadRepeatedSquats(s, kind == "six" ? 6 : 2);
  } catch (const std::invalid_argument& error) {
    s.Fail("depth_m", error.what());
  }
}

// Joint name -> trajectory, of both legs.
std::map<std::string, TrajectoryPtr> SquatJoints(const config::Section& s, const arm::Chain& chain,
                                                 const TrajectoryPtr& height) {
  std::map<std::string, TrajectoryPtr> joints;
  const double forward_m = s.NumberOr("foot_forward_m", 0.0);
  for (const std::string side : {"left", "right"}) {
    const leg::LegJointNames names = leg::NamesOfSide(side);
    leg::LegGeometry geometry;
    try {
      geometry = leg::GeometryOf(chain, names, side + "_sole");
    } catch (const std::invalid_argument& error) {
      s.Fail("urdf", error.what());
    }
    try {
      for (const auto& [joint, moved] : {std::pair{leg::kHipPitch, SquatJoint::kHipPitch},
                                         {leg::kKnee, SquatJoint::kKnee},
                                         {leg::kAnklePitch, SquatJoint::kAnklePitch}}) {
        joints[names[static_cast<std::size_t>(joint)]] =
            std::make_shared<SquatTrajectory>(height, geometry, forward_m, moved);
      }
    } catch (const std::invalid_argument& error) {
      s.Fail("depth_m", error.what());
    }
  }
  return joints;
}

}  // namespace

void ReadSquat(const config::Section& section, LoadedReference* loaded) {
  const std::filesystem::path urdf = section.ExistingPath("urdf");
  const arm::Chain chain = arm::ParseUrdf(config::ReadFile(urdf), urdf.string());
  const TrajectoryPtr height = ReadBaseHeight(section, loaded);
  const std::map<std::string, TrajectoryPtr> moved = SquatJoints(section, chain, height);

  GeneratorConfig common;
  common.soft_start_s = section.NumberOr("soft_start_s", 2.0, config::kNotNegative);
  common.soft_stop_s = section.NumberOr("soft_stop_s", 1.0, config::kNotNegative);
  const config::Section limits = section.Child("limits");
  common.limits.velocity_rad_s = limits.Number("velocity_rad_s", config::kPositive);
  common.limits.acceleration_rad_s2 = limits.Number("acceleration_rad_s2", config::kPositive);
  limits.RejectUnknownKeys();

  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsDriven(body)) continue;
    GeneratorConfig joint = common;
    joint.limits.position_lower_rad = body.lower;
    joint.limits.position_upper_rad = body.upper;
    const auto found = moved.find(body.joint_name);
    joint.trajectory =
        found != moved.end() ? found->second : std::make_shared<Hold>(0.0, height->duration_s());
    const std::string passed = FirstPassedLimit(body.joint_name, *joint.trajectory, joint.limits);
    if (!passed.empty()) section.Fail("limits", passed);
    loaded->joint_names.push_back(body.joint_name);
    loaded->config.joints.push_back(std::move(joint));
  }
  for (const auto& [name, trajectory] : moved) {
    if (std::find(loaded->joint_names.begin(), loaded->joint_names.end(), name) ==
        loaded->joint_names.end()) {
      section.Fail("urdf", "joint '" + name + "' has no effort above 0: it is not driven");
    }
  }
  if (loaded->config.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    section.Fail("urdf", "has " + std::to_string(loaded->config.joints.size()) +
                             " driven joints, expected at most " +
                             std::to_string(types::kMaxJoints));
  }
  section.RejectUnknownKeys();
}

}  // namespace sinew::reference
