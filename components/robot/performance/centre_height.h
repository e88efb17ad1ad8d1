// Height of a robot's centre of mass above what it stands on, from its joint angles.
//
//     h = z_c - min over the links on the ground of z_link,   c = sum m_i c_i / sum m_i
//
// z along the base's z axis: the base is taken as upright, which holds for a squat with an upright
// torso; leaned by an angle a, h is wrong by 1 - cos a of itself at least. Without a link on the
// ground the base is fixed, and h is above its origin. Joints that are not named stay at 0.
// m, rad; a prismatic joint m. Thread: one. Of is noexcept and allocates nothing.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>
#include <vector>

#include "components/bodies/links/bodies.h"

namespace sinew::performance {

class CentreHeight {
 public:
  // joint_names: in the order of the positions. on_ground: links, such as soles.
  // Throws std::invalid_argument: a joint or link that is not there, a joint that does not move, a
  // robot without mass.
  CentreHeight(const arm::Chain& chain, const std::vector<std::string>& joint_names,
               const std::vector<std::string>& on_ground);

  double mass_kg() const noexcept { return mass_kg_; }

  // position: one for each named joint. Not a number where one is missing or not finite.
  double Of(std::span<const double> position) noexcept;

 private:
  arm::Chain chain_;
  std::vector<arm::Coordinate> coordinates_;
  std::vector<std::size_t> moved_;        // body of each named joint
  std::vector<std::size_t> on_ground_;    // bodies
  std::vector<double> position_;          // of every body's joint
  std::vector<Eigen::Isometry3d> frame_;  // of every body, in the base's
  double mass_kg_ = 0.0;
};

}  // namespace sinew::performance
