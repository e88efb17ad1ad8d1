// A three-joint arm with a slide, off-axis masses and a body on a fixed joint.
#pragma once

#include <Eigen/Geometry>

#include "components/bodies/links/bodies.h"

namespace sinew::arm {

inline Body LinkOf(const char* name, int parent, const Eigen::Vector3d& at,
                   const Eigen::Vector3d& axis, double mass) {
  Body body;
  body.link_name = std::string(name) + "_link";
  body.joint_name = name;
  body.parent = parent;
  body.moves = true;
  body.parent_from_joint.translate(at);
  body.axis = axis.normalized();
  body.effort = 50.0;
  body.mass_kg = mass;
  body.com_m = {0.05, -0.03, 0.12};
  body.inertia_kg_m2 << 0.02, 0.003, 0.002, 0.003, 0.05, 0.001, 0.002, 0.001, 0.045;
  return body;
}

inline Chain RandomArm() {
  Chain chain;
  chain.name = "random_arm";
  chain.bodies.push_back(LinkOf("one", -1, {0.0, 0.1, 0.3}, {0.0, 0.3, 1.0}, 2.0));
  chain.bodies.push_back(LinkOf("two", 0, {0.2, 0.0, 0.1}, {0.0, 1.0, 0.2}, 1.3));
  Body tool = LinkOf("flange", 1, {0.1, 0.2, 0.0}, {1.0, 0.0, 0.0}, 0.4);
  tool.moves = false;
  tool.parent_from_joint.rotate(
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  chain.bodies.push_back(tool);
  Body slide = LinkOf("slide", 2, {0.0, 0.05, 0.2}, {1.0, 0.5, 0.0}, 0.8);
  slide.prismatic = true;
  chain.bodies.push_back(slide);
  chain.bodies.push_back(LinkOf("last", 3, {0.1, 0.0, 0.1}, {0.2, 0.1, 1.0}, 0.5));
  return chain;
}

}  // namespace sinew::arm
