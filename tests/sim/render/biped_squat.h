// The shipped biped in its published squat (robots/biped/reference_benchmark.yaml), for tests of
// pictures: joints by the reference's trajectories, base by its own height over time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/robot/reference/file/reference_file.h"
#include "components/robot/reference/squat.h"
#include "sim/render/file/scene_file.h"

namespace sinew::render {

inline constexpr double kStandingHeight_m = 0.776;  // base above the soles with straight legs
inline constexpr double kSquatTop_m = 0.02, kSquatDepth_m = 0.4;  // below the straight legs

class BipedSquat {
 public:
  BipedSquat()
      : scene_(LoadScene(Folder() + "biped.urdf")),
        reference_(reference::LoadReference(Folder() + "reference_benchmark.yaml")),
        indices_(JointIndices(scene_.chain, reference_.joint_names)) {}

  static std::string Folder() { return SINEW_SOURCE_DIR "/robots/biped/"; }
  const Scene& scene() const { return scene_; }

  // Of the squat alone, without soft start: at its top at 0, lowest at 2.5 s, 5 s a cycle.
  RobotPose At(double time_s) const {
    RobotPose pose = JointsAt(time_s);
    pose.world_from_base.translation().z() = kStandingHeight_m + Height_m(time_s);
    return pose;
  }
  // The same with the base at the origin.
  RobotPose JointsAt(double time_s) const {
    RobotPose pose;
    pose.joint_rad.assign(MovingJoints(scene_.chain).size(), 0.0);
    for (std::size_t i = 0; i < indices_.size(); ++i) {
      pose.joint_rad[indices_[i]] = reference_.config.joints[i].trajectory->At(time_s).position_rad;
    }
    return pose;
  }
  // Of the base, 0 with straight legs.
  double Height_m(double time_s) const { return squats_->At(time_s).position_rad; }

 private:
  Scene scene_;
  reference::LoadedReference reference_;
  std::vector<std::size_t> indices_;
  reference::TrajectoryPtr squats_ =
      reference::MakeSquats({.straight_margin_m = kSquatTop_m, .depth_m = kSquatDepth_m});
};

}  // namespace sinew::render
