// A pinhole camera, and where a point of the world is in its picture.
//
// SI units; world axes, z up. Thread: free functions. Allocates nothing.
#pragma once

#include <Eigen/Core>

#include "sim/render/scene.h"

namespace sinew::render {

struct Camera {
  Eigen::Vector3d eye_m = Eigen::Vector3d(2.0, 2.0, 1.0);
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  // in the middle of the picture
  double field_of_view_rad = 0.5;                      // from the lower to the upper edge
};

// Distances between which a camera sees, m.
inline constexpr double kNearest_m = 0.05;
inline constexpr double kFurthest_m = 100.0;

// OpenGL's clip coordinates (OpenGL 3.3, 2.14) of homogeneous points of the world. aspect: width
// over height.
Eigen::Matrix4d ClipFromWorld(const Camera& camera, double aspect);

// Pixels from the upper left corner of a picture of this size, x to the right, y down. The point is
// in front of the camera.
Eigen::Vector2d Project(const Camera& camera, int width, int height,
                        const Eigen::Vector3d& point_m);

enum class View {
  kThreeQuarter,  // from the front (forward: x) and the left of the robot, a little above
  kSide,          // from its left side, at right angles to its forward axis
};

// So far away that a sphere about the standing robot fits into the picture's height; of a robot on
// a fixed base a sphere about all its postures (PostureBox).
Camera CameraOf(const Scene& scene, View view, bool fixed_base = false);

// The same view of a robot that has moved: follows the base on the ground, never up or down, so
// that a squat is seen.
Camera Follow(const Camera& camera, const RobotPose& pose);

}  // namespace sinew::render
