#include "components/robot/performance/centre_height.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sinew::performance {

CentreHeight::CentreHeight(const arm::Chain& chain, const std::vector<std::string>& joint_names,
                           const std::vector<std::string>& on_ground)
    : chain_(chain),
      coordinates_(arm::CoordinatesOf(chain)),
      position_(chain.bodies.size(), 0.0),
      frame_(chain.bodies.size(), Eigen::Isometry3d::Identity()),
      mass_kg_(chain.base.mass_kg) {
  for (const std::string& name : joint_names) {
    const int body = arm::FindJoint(chain, name);
    if (body < 0 || !arm::IsFree(chain.bodies[static_cast<std::size_t>(body)])) {
      throw std::invalid_argument("the URDF has no joint '" + name + "' that moves by itself");
    }
    moved_.push_back(static_cast<std::size_t>(body));
  }
  for (const std::string& name : on_ground) {
    const auto found =
        std::find_if(chain.bodies.begin(), chain.bodies.end(),
                     [&name](const arm::Body& body) { return body.link_name == name; });
    if (found == chain.bodies.end()) {
      throw std::invalid_argument("the URDF has no link '" + name + "' beside its base");
    }
    on_ground_.push_back(static_cast<std::size_t>(found - chain.bodies.begin()));
  }
  for (const arm::Body& body : chain.bodies) mass_kg_ += body.mass_kg;
  if (!(mass_kg_ > 0.0)) throw std::invalid_argument("the URDF's links have no mass");
}

double CentreHeight::Of(std::span<const double> position) noexcept {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  if (position.size() < moved_.size()) return kUnknown;
  for (std::size_t j = 0; j < moved_.size(); ++j) {
    if (!std::isfinite(position[j])) return kUnknown;
    position_[moved_[j]] = position[j];
  }
  double moment_kg_m = chain_.base.mass_kg * chain_.base.com_m.z();
  for (std::size_t i = 0; i < frame_.size(); ++i) {  // parents come first
    const arm::Body& body = chain_.bodies[i];
    frame_[i] = body.parent < 0
                    ? body.parent_from_joint
                    : frame_[static_cast<std::size_t>(body.parent)] * body.parent_from_joint;
    const arm::Coordinate& at = coordinates_[i];
    const double q = at.body < 0
                         ? 0.0
                         : at.multiplier * position_[static_cast<std::size_t>(at.body)] + at.offset;
    if (body.prismatic) {
      frame_[i].translate(q * body.axis);
    } else {
      frame_[i].rotate(Eigen::AngleAxisd(q, body.axis));
    }
    moment_kg_m += body.mass_kg * (frame_[i] * body.com_m).z();
  }
  double ground_m = on_ground_.empty() ? 0.0 : std::numeric_limits<double>::infinity();
  for (const std::size_t i : on_ground_) {
    ground_m = std::min(ground_m, frame_[i].translation().z());
  }
  return moment_kg_m / mass_kg_ - ground_m;
}

}  // namespace sinew::performance
