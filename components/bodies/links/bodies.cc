#include "components/bodies/links/bodies.h"

#include <stdexcept>

namespace sinew::arm {

namespace {

// A body's frame in the frame of the moving body it is fixed to.
Eigen::Isometry3d FrameIn(const Chain& chain, int body, int root) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  while (body != root) {
    const Body& of = chain.bodies[static_cast<std::size_t>(body)];
    frame = of.parent_from_joint * frame;
    body = of.parent;
  }
  return frame;
}

}  // namespace

int FindJoint(const Chain& chain, const std::string& joint_name) {
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    if (chain.bodies[i].moves && chain.bodies[i].joint_name == joint_name) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

std::vector<Coordinate> CoordinatesOf(const Chain& chain) {
  std::vector<Coordinate> coordinates(chain.bodies.size());
  int joints = 0;
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    if (IsFree(chain.bodies[i])) coordinates[i] = {.joint = joints++, .body = static_cast<int>(i)};
  }
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    const std::optional<Mimic>& mimic = chain.bodies[i].mimic;
    if (!chain.bodies[i].moves || !mimic) continue;
    const int of = FindJoint(chain, mimic->joint_name);
    coordinates[i] = coordinates.at(static_cast<std::size_t>(of));
    coordinates[i].multiplier = mimic->multiplier;
    coordinates[i].offset = mimic->offset;
  }
  return coordinates;
}

void RequireFree(const Body& body) {
  if (!body.mimic) return;
  throw std::invalid_argument("joint '" + body.joint_name + "' mimics '" + body.mimic->joint_name +
                              "' in the URDF and moves with it, expected no model of it");
}

void OverrideLink(Chain& chain, int body_index, double inertia, bool gravity_elsewhere) {
  Body& body = chain.bodies[static_cast<std::size_t>(body_index)];
  const std::string name = "joint '" + body.joint_name + "'";
  for (int p = body.parent; p >= 0; p = chain.bodies[static_cast<std::size_t>(p)].parent) {
    if (chain.bodies[static_cast<std::size_t>(p)].moves) {
      throw std::invalid_argument(
          name + " is not on the fixed base: its link inertia and gravity belong in the URDF");
    }
  }
  for (const Body& other : chain.bodies) {
    if (!other.mimic || other.mimic->joint_name != body.joint_name) continue;
    throw std::invalid_argument(name + " moves '" + other.joint_name +
                                "', which mimics it: its link inertia and gravity belong in the "
                                "URDF");
  }
  double mass = 0.0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();
  for (int k = body_index; k < static_cast<int>(chain.bodies.size()); ++k) {
    Body& other = chain.bodies[static_cast<std::size_t>(k)];
    bool below = false;
    for (int p = k; p >= body_index; p = chain.bodies[static_cast<std::size_t>(p)].parent) {
      below |= p == body_index;
    }
    if (!below) continue;
    if (k != body_index && other.moves) {
      throw std::invalid_argument(
          name + " carries moving links: its link inertia and gravity belong in the URDF");
    }
    if (gravity_elsewhere) other.weightless = true;
    if (inertia > 0.0) {
      mass += other.mass_kg;
      first_moment += other.mass_kg * (FrameIn(chain, k, body_index) * other.com_m);
      if (k != body_index) {
        other.mass_kg = 0.0;
        other.inertia_kg_m2.setZero();
      }
    }
  }
  if (!(inertia > 0.0)) return;
  if (body.prismatic) {
    body.com_m = first_moment / mass;
    body.mass_kg = inertia;
    return;
  }
  body.mass_kg = mass;
  if (gravity_elsewhere) {
    // Only the inertia about the axis acts.
    body.com_m.setZero();
    body.inertia_kg_m2 = inertia * Eigen::Matrix3d::Identity();
    return;
  }
  body.com_m = first_moment / mass;
  const double arm = body.axis.cross(body.com_m).norm();
  const double about_com = inertia - mass * arm * arm;
  if (!(about_com > 0.0)) {
    throw std::invalid_argument(name + ": the model's inertia " + std::to_string(inertia) +
                                " kg m^2 is less than that of the URDF's mass alone, " +
                                std::to_string(mass * arm * arm) + " kg m^2");
  }
  body.inertia_kg_m2 = about_com * Eigen::Matrix3d::Identity();
}

}  // namespace sinew::arm
