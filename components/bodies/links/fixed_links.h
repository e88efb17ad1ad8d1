// A chain with every link on a fixed joint merged into the link that carries it, for simulations:
// the same motion with fewer bodies. What was merged stays a frame with a name. Pure; any thread.
// Allocates.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"

namespace sinew::arm {

// A link as a frame of the body it moves with.
struct LinkFrame {
  std::string link_name;
  int body = -1;  // of the merged chain; -1: base
  Eigen::Isometry3d body_from_link = Eigen::Isometry3d::Identity();
};

struct MergedChain {
  Chain chain;                    // all bodies move; names of the joints are those of before
  std::vector<LinkFrame> frames;  // of every link of before, the base first, then as its bodies
};

// The frame of a merged link is that of the link that carries it: the base keeps the frame of the
// root link. Throws std::invalid_argument: a link and one fixed to it of which only one is
// weightless (OverrideLink makes both so).
MergedChain MergeFixedLinks(const Chain& chain);

// The frame of a link, or nullptr.
const LinkFrame* FindLink(const MergedChain& merged, const std::string& link_name);

// Adds a point mass at point_m of the link's frame to a body, or to the base.
void AddPointMass(double mass_kg, const Eigen::Vector3d& point_m, Body* body);
void AddPointMass(double mass_kg, const Eigen::Vector3d& point_m, Base* base);

}  // namespace sinew::arm
