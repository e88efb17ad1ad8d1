#include "components/bodies/links/fixed_links.h"

#include <stdexcept>

namespace sinew::arm {

namespace {

// Inertia about a point at `offset` from the centre of mass of a point mass.
Eigen::Matrix3d OfPoint(double mass_kg, const Eigen::Vector3d& offset) {
  return mass_kg *
         (offset.squaredNorm() * Eigen::Matrix3d::Identity() - offset * offset.transpose());
}

// into: a Body or a Base. com, inertia: of what is added, in the frame of `into`.
template <typename Inertial>
void Merge(double mass_kg, const Eigen::Vector3d& com_m, const Eigen::Matrix3d& inertia_kg_m2,
           Inertial* into) {
  const double total = into->mass_kg + mass_kg;
  if (!(total > 0.0)) return;
  const Eigen::Vector3d com = (into->mass_kg * into->com_m + mass_kg * com_m) / total;
  into->inertia_kg_m2 +=
      OfPoint(into->mass_kg, into->com_m - com) + inertia_kg_m2 + OfPoint(mass_kg, com_m - com);
  into->com_m = com;
  into->mass_kg = total;
}

}  // namespace

MergedChain MergeFixedLinks(const Chain& chain) {
  MergedChain merged;
  merged.chain.name = chain.name;
  merged.chain.base = chain.base;
  merged.frames.push_back({.link_name = chain.base.link_name});
  for (const Body& body : chain.bodies) {
    const LinkFrame& parent = merged.frames[static_cast<std::size_t>(body.parent + 1)];
    LinkFrame frame{.link_name = body.link_name, .body = parent.body};
    const Eigen::Isometry3d carrier_from_joint = parent.body_from_link * body.parent_from_joint;
    if (body.moves) {
      Body moving = body;
      moving.parent = parent.body;
      moving.parent_from_joint = carrier_from_joint;
      frame.body = static_cast<int>(merged.chain.bodies.size());
      merged.chain.bodies.push_back(moving);
    } else {
      frame.body_from_link = carrier_from_joint;
      const Eigen::Vector3d com = carrier_from_joint * body.com_m;
      const Eigen::Matrix3d axes = carrier_from_joint.linear();
      const Eigen::Matrix3d inertia = axes * body.inertia_kg_m2 * axes.transpose();
      if (parent.body < 0) {
        if (body.weightless) {
          throw std::invalid_argument("link '" + body.link_name + "': weightless on the base");
        }
        Merge(body.mass_kg, com, inertia, &merged.chain.base);
      } else {
        Body& carrier = merged.chain.bodies[static_cast<std::size_t>(parent.body)];
        if (carrier.weightless != body.weightless) {
          throw std::invalid_argument("links '" + carrier.link_name + "' and '" + body.link_name +
                                      "' are one body, but only one of them has weight");
        }
        Merge(body.mass_kg, com, inertia, &carrier);
      }
    }
    merged.frames.push_back(frame);
  }
  return merged;
}

const LinkFrame* FindLink(const MergedChain& merged, const std::string& link_name) {
  for (const LinkFrame& frame : merged.frames) {
    if (frame.link_name == link_name) return &frame;
  }
  return nullptr;
}

void AddPointMass(double mass_kg, const Eigen::Vector3d& point_m, Body* body) {
  Merge(mass_kg, point_m, Eigen::Matrix3d::Zero(), body);
}

void AddPointMass(double mass_kg, const Eigen::Vector3d& point_m, Base* base) {
  Merge(mass_kg, point_m, Eigen::Matrix3d::Zero(), base);
}

}  // namespace sinew::arm
