#include "components/robot/reference/file/squat_file.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "components/base/types/joints.h"
#include "components/base/types/text.h"
#include "components/bodies/leg/geometry.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/robot/reference/squat.h"

namespace sinew::reference {
using config::kPositive;

namespace {

// The height of the base over time, made when all keys were read.
using MakeHeight = std::function<TrajectoryPtr()>;

MakeHeight DescribeHeight(config::Fields& f, LoadedReference* loaded) {
  ChirpSquatConfig c;
  SquatsConfig squats;
  const auto kind =
      f.NeedWord("kind", {"benchmark", "six", "chirp"}, "two squats, six, or the published chirp");
  f.Need("depth_m", c.depth_m, kPositive, "of the lowest point below straight legs");
  f("straight_margin_m", c.straight_margin_m, kPositive,
    "of the highest point: a straight leg is singular");
  if (const auto repeated = kind.Is({"benchmark", "six"})) {
    f("period_s", squats.period_s, kPositive, "top, bottom, top as a cosine");
  }
  if (const auto chirp = kind.Is({"chirp"})) {
    f("acceleration_m_s2", c.acceleration_m_s2, kPositive, "of the base, at most; below 1 g");
    f("duration_s", c.shape.duration_s, kPositive, "of the chirp");
    f("start_frequency_Hz", c.shape.start_frequency_Hz, kPositive, "f0");
    f("end_frequency_Hz", c.shape.end_frequency_Hz, kPositive, "f1");
  }
  if (kind.word != "chirp") {
    squats.depth_m = c.depth_m;
    squats.straight_margin_m = c.straight_margin_m;
    squats.cycles = kind.word == "six" ? 6 : 2;
    return [squats] { return MakeSquats(squats); };
  }
  return [c, loaded]() -> TrajectoryPtr {
    const auto chirp = std::make_shared<ChirpSquat>(c);
    loaded->notes.push_back(types::Text(
        "squat: amplitude %.4g m, drawn in to %.4g m at the end to keep %.4g m/s2",
        0.5 * (c.depth_m - c.straight_margin_m), chirp->end_amplitude_m(), c.acceleration_m_s2));
    return chirp;
  };
}

// Joint name -> trajectory, of both legs.
std::map<std::string, TrajectoryPtr> SquatJoints(const config::Fields& f, const arm::Chain& chain,
                                                 const TrajectoryPtr& height, double forward_m) {
  std::map<std::string, TrajectoryPtr> joints;
  for (const std::string side : {"left", "right"}) {
    const leg::LegJointNames names = leg::NamesOfSide(side);
    leg::LegGeometry geometry;
    f.Check("urdf", [&] { geometry = leg::GeometryOf(chain, names, side + "_sole"); });
    f.Check("depth_m", [&] {
      for (const auto& [joint, moved] : {std::pair{leg::kHipPitch, SquatJoint::kHipPitch},
                                         {leg::kKnee, SquatJoint::kKnee},
                                         {leg::kAnklePitch, SquatJoint::kAnklePitch}}) {
        joints[names[static_cast<std::size_t>(joint)]] =
            std::make_shared<SquatTrajectory>(height, geometry, forward_m, moved);
      }
    });
  }
  return joints;
}

}  // namespace

void DescribeSquat(config::Fields& f, LoadedReference* loaded) {
  std::filesystem::path urdf;
  double forward_m = 0.0;
  GeneratorConfig common;
  f.Need("urdf", urdf, "the robot; its driven joints are those of the topics, in its order");
  const MakeHeight make_height = DescribeHeight(f, loaded);
  f("foot_forward_m", forward_m, "the ankle's place in front of the hip");
  f("soft_start_s", common.soft_start_s, config::kNotNegative, "onto the motion");
  f("soft_stop_s", common.soft_stop_s, config::kNotNegative, "to rest");
  f.NeedObject("limits", "of every joint; positions: the URDF's limits", [&](config::Fields& l) {
    l.Need("velocity_rad_s", common.limits.velocity_rad_s, kPositive, "largest");
    l.Need("acceleration_rad_s2", common.limits.acceleration_rad_s2, kPositive, "largest");
  });
  if (!f.reads()) return;
  const arm::Chain chain = arm::ParseUrdf(config::ReadFile(urdf), urdf.string());
  TrajectoryPtr height;
  f.Check("depth_m", [&] { height = make_height(); });
  const std::map<std::string, TrajectoryPtr> moved = SquatJoints(f, chain, height, forward_m);
  for (const arm::Body& body : chain.bodies) {
    if (!arm::IsDriven(body)) continue;
    GeneratorConfig joint = common;
    joint.limits.position_lower_rad = body.lower;
    joint.limits.position_upper_rad = body.upper;
    const auto found = moved.find(body.joint_name);
    joint.trajectory =
        found != moved.end() ? found->second : std::make_shared<Hold>(0.0, height->duration_s());
    const std::string passed = FirstPassedLimit(body.joint_name, *joint.trajectory, joint.limits);
    if (!passed.empty()) f.Fail("limits", passed);
    loaded->joint_names.push_back(body.joint_name);
    loaded->config.joints.push_back(std::move(joint));
  }
  for (const auto& [name, trajectory] : moved) {
    if (std::find(loaded->joint_names.begin(), loaded->joint_names.end(), name) ==
        loaded->joint_names.end()) {
      f.Fail("urdf", "joint '" + name + "' has no effort above 0: it is not driven");
    }
  }
  if (loaded->config.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    f.Fail("urdf", "has " + std::to_string(loaded->config.joints.size()) +
                       " driven joints, expected at most " + std::to_string(types::kMaxJoints));
  }
}

}  // namespace sinew::reference
