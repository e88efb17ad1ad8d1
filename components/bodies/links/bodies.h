// The bodies and joints of a robot on a fixed or floating base: a tree of revolute, prismatic and
// fixed joints. SI units; a prismatic joint has m and N where a revolute one has rad and Nm. Plain
// data: any thread.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sinew::arm {

// Spring and damper of a joint without a drive, at rest at position 0: tau = -k q - c q'.
struct Passive {
  double stiffness_Nm_rad = 0.0;  // at least 0
  double damping_Nms_rad = 0.0;   // at least 0
};

// A joint that follows another of its tree: position = multiplier x the other's + offset, rad or m.
struct Mimic {
  std::string joint_name;  // moves and follows none itself
  double multiplier = 1.0, offset = 0.0;
};

// A link other than the base, with the joint that carries it. Links come parents first.
struct Body {
  std::string link_name, joint_name;
  int parent = -1;     // index of a body; -1: the base
  bool moves = false;  // false: fixed joint
  bool prismatic = false;
  Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();  // at position 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();                      // unit, in the link's frame
  double lower = -std::numeric_limits<double>::infinity();              // end stops, rad
  double upper = std::numeric_limits<double>::infinity();
  double effort = 0.0;  // limit of the URDF, Nm or N; 0: not stated
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();          // in the link's frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  // about the centre of mass, link's axes
  std::optional<Passive> passive;                           // of a moving joint without a drive
  std::optional<Mimic> mimic;                               // of a moving joint
  bool weightless = false;  // gravity acts through a term of the joint model
};

// The base link. A fixed base needs none of it.
struct Base {
  std::string link_name;
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();          // in the link's frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  // about the centre of mass, link's axes
};

struct Chain {
  std::string name;
  std::vector<Body> bodies;
  Base base = {};
};

// Moved by a motor of its own: the joints of the topics are those, in the chain's order.
inline bool IsDriven(const Body& body) noexcept {
  return body.moves && !body.mimic && body.effort > 0.0;
}

// Has a position of its own.
inline bool IsFree(const Body& body) noexcept { return body.moves && !body.mimic; }

// Index of the body that a joint moves, or -1.
int FindJoint(const Chain& chain, const std::string& joint_name);

// Position of a body's joint: multiplier x that of free joint number `joint` + offset.
struct Coordinate {
  int joint = -1, body = -1;  // of the free joint, in the chain's order; -1: a fixed joint
  double multiplier = 1.0, offset = 0.0;
};

// One for each body.
std::vector<Coordinate> CoordinatesOf(const Chain& chain);

// Throws std::invalid_argument naming a joint that mimics another: it has no model of its own.
void RequireFree(const Body& body);

// Replaces the inertia about the joint's axis (kg m^2; of a prismatic joint the mass, kg) of the
// joint's link and what is fixed to it. `inertia` of 0 or less keeps that of the URDF.
// gravity_elsewhere: gravity acts through a term of the joint model, so it no longer acts on the
// link. Throws std::invalid_argument: the joint is not on the fixed base, the link carries moving
// links, another joint mimics this one, or the inertia is smaller than mass x distance^2 of the
// URDF's centre of mass.
void OverrideLink(Chain& chain, int body_index, double inertia, bool gravity_elsewhere);

}  // namespace sinew::arm
