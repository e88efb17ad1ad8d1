// Poses of a robot from a recording, at a constant rate.
//
// Joints: joint_state, whose joints are, in order, those that the URDF drives (they move and have
// an effort above 0), or all that move where it drives another number. Joints without a
// measurement, such as the elastic segments of a foot, stay at 0.
//
// Base: sim_body_truth where the recording has it. Else, of a robot with the links left_sole and
// right_sole, leg kinematics: the sole that is lower below an upright base is flat on the ground
// where it was when the robot stood, so that the base leans and sinks as the joints say. Else the
// base is fixed (MountedPose).
#pragma once

#include <filesystem>
#include <limits>
#include <vector>

#include "sim/render/scene.h"

namespace sinew::render {

struct TimedPose {
  double time_s = 0.0;  // since the first joint_state
  RobotPose pose;
};

struct RecordedPosesOptions {
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  int frames_per_s = 25;
};

struct RecordedPoses {
  std::vector<TimedPose> poses;
  bool fixed_base = false;
};

// A pose for each of from_s, from_s + 1 / frames_per_s and so on: the newest of that time. Of
// several sessions the first. Throws UsageError naming file and what is missing: no joint_state, a
// number of joints that is not the robot's, no state in the range.
RecordedPoses ReadPoses(const std::filesystem::path& recording, const Scene& scene,
                        const RecordedPosesOptions& options);

// Without sim_body_truth: the base as the joints say, see above. False: it is fixed.
bool PlaceBase(const Scene& scene, RobotPose* pose);

}  // namespace sinew::render
