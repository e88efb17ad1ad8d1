// The links of a tree that move against each other: bodies on fixed joints are part of the link
// that carries them, or of the base. Set-up only. Plain data: any thread. Allocates.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "components/bodies/links/inertial.h"

namespace sinew::arm {

inline constexpr int kBaseLink = -1;

struct MovingLink {
  int parent = kBaseLink;  // a link before this one, or the base
  bool prismatic = false;
  Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();  // at position 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();                      // unit, in the link's frame
  std::string link_name, joint_name;
  Inertial inertial = Inertial::Zero();  // about the origin of the link's frame
};

// A body's place: fixed to a link.
struct Carried {
  int link = kBaseLink;
  Eigen::Isometry3d link_from_body = Eigen::Isometry3d::Identity();
};

struct MovingLinks {
  std::vector<MovingLink> links;         // in the order of the chain's moving bodies
  Inertial base = Inertial::Zero();      // of the base, about its origin
  std::vector<Carried> bodies;           // in the order of the chain's bodies
  std::vector<std::string> joint_names;  // of the links
};

// Throws std::invalid_argument naming a joint that mimics another.
MovingLinks MovingLinksOf(const Chain& chain);

// "link.m", "link.mx", ..., "link.Izz": appends the names of a body's ten parameters.
void AppendParameterNames(const std::string& link_name, std::vector<std::string>* names);

}  // namespace sinew::arm
