#include "sim/render/camera.h"

#include <cmath>
#include <numbers>

namespace sinew::render {

namespace {

using Eigen::Vector3d;

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kFieldOfView_rad = 26.0 * kDegree_rad;  // of a lens of 52 mm on 24 mm x 36 mm
constexpr double kMargin = 1.08;                         // of the picture around the robot

struct Direction {
  double azimuth_rad;    // from forward to the left
  double elevation_rad;  // above the horizon
};

Direction DirectionOf(View view) {
  if (view == View::kSide) return {90.0 * kDegree_rad, 6.0 * kDegree_rad};
  return {50.0 * kDegree_rad, 14.0 * kDegree_rad};
}

}  // namespace

Eigen::Matrix4d ClipFromWorld(const Camera& camera, double aspect) {
  const Vector3d back = (camera.eye_m - camera.target_m).normalized();
  const Vector3d right = Vector3d::UnitZ().cross(back).normalized();
  const Vector3d up = back.cross(right);
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.row(0) << right.transpose(), -right.dot(camera.eye_m);
  view.row(1) << up.transpose(), -up.dot(camera.eye_m);
  view.row(2) << back.transpose(), -back.dot(camera.eye_m);
  const double focal = 1.0 / std::tan(0.5 * camera.field_of_view_rad);
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = focal / aspect;
  projection(1, 1) = focal;
  projection(2, 2) = (kFurthest_m + kNearest_m) / (kNearest_m - kFurthest_m);
  projection(2, 3) = 2.0 * kFurthest_m * kNearest_m / (kNearest_m - kFurthest_m);
  projection(3, 2) = -1.0;
  return projection * view;
}

Eigen::Vector2d Project(const Camera& camera, int width, int height, const Vector3d& point_m) {
  const Eigen::Vector4d clip =
      ClipFromWorld(camera, static_cast<double>(width) / height) * point_m.homogeneous();
  return {0.5 * width * (1.0 + clip.x() / clip.w()), 0.5 * height * (1.0 - clip.y() / clip.w())};
}

Camera CameraOf(const Scene& scene, View view, bool fixed_base) {
  Camera camera;
  camera.field_of_view_rad = kFieldOfView_rad;
  double radius_m = 1.0;
  if (fixed_base && !scene.visuals.empty()) {
    const Eigen::AlignedBox3d box = PostureBox(scene);
    camera.target_m = MountedPose(scene).world_from_base * box.center();
    radius_m = 0.5 * box.sizes().maxCoeff();  // of the balls in it, not of its corners
  } else if (!scene.visuals.empty()) {
    const Eigen::AlignedBox3d box = Extent(scene, StandingPose(scene));
    camera.target_m = box.center();
    radius_m = 0.5 * box.diagonal().norm();
  }
  const auto [azimuth_rad, elevation_rad] = DirectionOf(view);
  const double distance_m = kMargin * radius_m / std::sin(0.5 * camera.field_of_view_rad);
  camera.eye_m =
      camera.target_m + distance_m * Vector3d(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                              std::cos(elevation_rad) * std::sin(azimuth_rad),
                                              std::sin(elevation_rad));
  return camera;
}

Camera Follow(const Camera& camera, const RobotPose& pose) {
  Vector3d moved_m = pose.world_from_base.translation();
  moved_m.z() = 0.0;
  Camera out = camera;
  out.eye_m += moved_m;
  out.target_m += moved_m;
  return out;
}

}  // namespace sinew::render
