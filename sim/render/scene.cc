#include "sim/render/scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::render {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d FrameOf(const std::vector<Isometry3d>& links, const RobotPose& pose, int body) {
  return body < 0 ? pose.world_from_base : links[static_cast<std::size_t>(body)];
}

}  // namespace

std::vector<std::string> MovingJoints(const arm::Chain& chain) {
  std::vector<std::string> names;
  for (const arm::Body& body : chain.bodies) {
    if (arm::IsFree(body)) names.push_back(body.joint_name);
  }
  return names;
}

std::vector<std::size_t> JointIndices(const arm::Chain& chain,
                                      const std::vector<std::string>& names) {
  const std::vector<std::string> moving = MovingJoints(chain);
  std::vector<std::size_t> indices;
  for (const std::string& name : names) {
    const auto found = std::find(moving.begin(), moving.end(), name);
    if (found == moving.end()) {
      throw std::invalid_argument("joint '" + name + "': no moving joint of this name");
    }
    indices.push_back(static_cast<std::size_t>(found - moving.begin()));
  }
  return indices;
}

std::vector<Isometry3d> LinkFrames(const arm::Chain& chain, const RobotPose& pose) {
  std::vector<Isometry3d> frames;
  frames.reserve(chain.bodies.size());
  const std::vector<arm::Coordinate> coordinates = arm::CoordinatesOf(chain);
  for (const arm::Body& body : chain.bodies) {
    Isometry3d frame = FrameOf(frames, pose, body.parent) * body.parent_from_joint;
    if (body.moves) {
      const arm::Coordinate& at = coordinates[frames.size()];
      const auto joint = static_cast<std::size_t>(at.joint);
      if (joint >= pose.joint_rad.size()) {
        throw std::invalid_argument("joint '" + body.joint_name + "' has no position");
      }
      const double position = at.multiplier * pose.joint_rad[joint] + at.offset;
      if (body.prismatic) {
        frame.translate(position * body.axis);
      } else {
        frame.rotate(Eigen::AngleAxisd(position, body.axis));
      }
    }
    frames.push_back(frame);
  }
  return frames;
}

double Reach(const Visual& visual, const Isometry3d& world_from_link, const Vector3d& direction) {
  const Isometry3d frame = world_from_link * visual.link_from_visual;
  const Vector3d d = frame.linear().transpose() * direction;
  const double center = direction.dot(frame.translation());
  switch (visual.shape) {
    case Shape::kBox:
      return center + 0.5 * d.cwiseAbs().dot(visual.size_m);
    case Shape::kCylinder:
      return center + visual.size_m.x() * std::hypot(d.x(), d.y()) +
             0.5 * visual.size_m.z() * std::abs(d.z());
    case Shape::kSphere:
      break;
  }
  return center + visual.size_m.x() * d.norm();
}

Eigen::AlignedBox3d Extent(const Scene& scene, const RobotPose& pose) {
  const std::vector<Isometry3d> links = LinkFrames(scene.chain, pose);
  Eigen::AlignedBox3d box;
  for (const Visual& visual : scene.visuals) {
    const Isometry3d frame = FrameOf(links, pose, visual.body);
    Vector3d least, most;
    for (int axis = 0; axis < 3; ++axis) {
      most[axis] = Reach(visual, frame, Vector3d::Unit(axis));
      least[axis] = -Reach(visual, frame, -Vector3d::Unit(axis));
    }
    box.extend(least);
    box.extend(most);
  }
  return box;
}

RobotPose StandingPose(const Scene& scene) {
  RobotPose pose;
  pose.joint_rad.assign(MovingJoints(scene.chain).size(), 0.0);
  if (!scene.visuals.empty()) {
    pose.world_from_base.translation().z() = -Extent(scene, pose).min().z();
  }
  return pose;
}

Eigen::AlignedBox3d PostureBox(const Scene& scene) {
  // Ball of a link's origin, around the first moving joint that carries it, or its own place.
  struct Ball {
    Vector3d center = Vector3d::Zero();
    double radius_m = 0.0;
    bool moves = false;
  };
  RobotPose zero;
  zero.joint_rad.assign(MovingJoints(scene.chain).size(), 0.0);
  const std::vector<Isometry3d> links = LinkFrames(scene.chain, zero);
  std::vector<Ball> balls;
  for (std::size_t i = 0; i < scene.chain.bodies.size(); ++i) {
    const arm::Body& body = scene.chain.bodies[i];
    Ball ball = body.parent < 0 ? Ball{} : balls[static_cast<std::size_t>(body.parent)];
    if (ball.moves) {
      ball.radius_m += body.parent_from_joint.translation().norm();
    } else {
      ball.center = links[i].translation();
    }
    ball.moves = ball.moves || body.moves;
    for (const double limit_m : {body.lower, body.upper}) {
      if (body.prismatic && std::isfinite(limit_m)) ball.radius_m += std::abs(limit_m);
    }
    balls.push_back(ball);
  }
  Eigen::AlignedBox3d box;
  for (const Visual& visual : scene.visuals) {
    const Ball ball = visual.body < 0 ? Ball{} : balls[static_cast<std::size_t>(visual.body)];
    const double size_m = visual.shape == Shape::kBox ? 0.5 * visual.size_m.norm()
                          : visual.shape == Shape::kCylinder
                              ? std::hypot(visual.size_m.x(), 0.5 * visual.size_m.z())
                              : visual.size_m.x();
    const double radius_m = ball.radius_m + visual.link_from_visual.translation().norm() + size_m;
    box.extend(ball.center - Vector3d::Constant(radius_m));
    box.extend(ball.center + Vector3d::Constant(radius_m));
  }
  return box;
}

RobotPose MountedPose(const Scene& scene) {
  RobotPose pose;
  pose.joint_rad.assign(MovingJoints(scene.chain).size(), 0.0);
  if (!scene.visuals.empty()) {
    pose.world_from_base.translation().z() = std::max(0.0, -PostureBox(scene).min().z());
  }
  return pose;
}

void StandOnLink(const arm::Chain& chain, const std::string& link,
                 const Isometry3d& world_from_link, RobotPose* pose) {
  const auto found = std::find_if(chain.bodies.begin(), chain.bodies.end(),
                                  [&](const arm::Body& body) { return body.link_name == link; });
  if (found == chain.bodies.end()) {
    throw std::invalid_argument("link '" + link + "': no link of this name");
  }
  pose->world_from_base.setIdentity();
  const Isometry3d base_from_link =
      LinkFrames(chain, *pose)[static_cast<std::size_t>(found - chain.bodies.begin())];
  pose->world_from_base = world_from_link * base_from_link.inverse();
}

}  // namespace sinew::render
