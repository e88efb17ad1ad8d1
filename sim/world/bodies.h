// The bodies and joints of a fixed-base tree: revolute, prismatic and fixed joints.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

namespace sinew::world {

// A link other than the base, with the joint that carries it. Links come parents first.
struct Body {
  std::string link_name, joint_name;
  int parent = -1;     // index of a body; -1: the fixed base
  bool moves = false;  // false: fixed joint
  bool prismatic = false;
  Eigen::Isometry3d parent_from_joint = Eigen::Isometry3d::Identity();  // at position 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();                      // unit, in the link's frame
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  double effort = 0.0;  // limit of the URDF, Nm or N; 0: not stated
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();          // in the link's frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  // about the centre of mass, link's axes
  bool weightless = false;                                  // gravity is somebody else's
};

struct Chain {
  std::string name;
  std::vector<Body> bodies;
};

// Index of the body that a joint moves, or -1.
int FindJoint(const Chain& chain, const std::string& joint_name);

// Gives the joint's link (with what is fixed to it) an inertia about the joint's axis, or a mass if
// it is prismatic, and says whether gravity still acts on it. `inertia` not above 0 keeps that of
// the URDF. Throws std::invalid_argument: the joint is not on the fixed base, moving links hang on
// it, or the inertia is less than the link's mass at its centre of mass has.
void OverrideLink(Chain& chain, int body, double inertia, bool gravity_elsewhere);

}  // namespace sinew::world
