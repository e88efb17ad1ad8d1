// Appearance of a robot: its bodies and the coloured shapes on them, and where these are in a pose.
//
// SI units; world axes, z up, the ground is z = 0. Thread: free functions of plain data.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"

namespace sinew::render {

enum class Shape { kBox, kCylinder, kSphere };

struct Colour {  // sRGB, 0 to 1
  double red = 0.7;
  double green = 0.7;
  double blue = 0.7;
};

struct Visual {
  int body = -1;  // index of a body of the chain; -1: the base
  Eigen::Isometry3d link_from_visual = Eigen::Isometry3d::Identity();
  Shape shape = Shape::kBox;
  // Box: its edges. Cylinder: radius, radius, length along z. Sphere: radius three times.
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();
  Colour colour;
};

struct Scene {
  arm::Chain chain;
  std::vector<Visual> visuals;
  int mesh_count = 0;  // visuals of the URDF that are meshes, which are not drawn
};

struct RobotPose {
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  std::vector<double> joint_rad;  // as MovingJoints; m of a prismatic joint
};

// Names of the joints that move and mimic no other, in the order of the chain.
std::vector<std::string> MovingJoints(const arm::Chain& chain);

// Index in MovingJoints of each name. Throws std::invalid_argument naming one that is not there.
std::vector<std::size_t> JointIndices(const arm::Chain& chain,
                                      const std::vector<std::string>& names);

// world_from_link of every body, in the order of the chain. The pose has a value for each joint
// that moves, else std::invalid_argument is thrown.
std::vector<Eigen::Isometry3d> LinkFrames(const arm::Chain& chain, const RobotPose& pose);

// Largest coordinate of a shape along a direction of the world's axes, m when that is a unit
// vector.
double Reach(const Visual& visual, const Eigen::Isometry3d& world_from_link,
             const Eigen::Vector3d& direction);

// Box along the world's axes around all shapes.
Eigen::AlignedBox3d Extent(const Scene& scene, const RobotPose& pose);

// All joints at 0, the base upright, x and y 0, so high that the lowest shape touches the ground.
RobotPose StandingPose(const Scene& scene);

// Box, in the base's frame, around all shapes in all postures: whatever the joints' positions, a
// shape is no further from the first moving joint that carries it than the links between are long.
Eigen::AlignedBox3d PostureBox(const Scene& scene);

// The pose of a robot whose base is fixed, such as a hanging arm: all joints at 0, the base
// upright, x and y 0, on the ground, or so high that no posture reaches below it.
RobotPose MountedPose(const Scene& scene);

// Moves a pose so that a link's frame, its origin on the ground, has this place and heading:
// world_from_link = (x, y, 0) and a rotation about z. What a robot whose sole is flat on the ground
// knows of its base: leg kinematics. Throws std::invalid_argument: no such link.
void StandOnLink(const arm::Chain& chain, const std::string& link,
                 const Eigen::Isometry3d& world_from_link, RobotPose* pose);

}  // namespace sinew::render
