#include "sim/world/contact.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "components/base/types/gravity.h"
#include "components/base/types/require.h"

namespace sinew::world {

double DampingOfRestitution(double restitution) {
  // The right side less the left one is 0 at 0, falls until x = (1 - e) / e, where its derivative
  // changes its sign once, and grows without bound towards 1/e: one root lies between.
  const double e = restitution;
  const auto excess = [e](double x) { return std::log1p(x) - std::log1p(-e * x) - (1.0 + e) * x; };
  double low = (1.0 - e) / e, high = 1.0 / e;
  for (int k = 0; k < 200 && high - low > 1e-15 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (excess(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

GroundLaw::GroundLaw(const GroundConfig& config) {
  const auto require = [](bool holds, const char* name, double value, const char* expected) {
    types::Require(holds, std::string("ground: ") + name, value, expected);
  };
  require(true, "height_m", config.height_m, "a finite number");
  require(config.friction >= 0.0, "friction", config.friction, "at least 0");
  require(config.static_load_N > 0.0, "static_load_N", config.static_load_N, "above 0");
  require(config.static_sink_m > 0.0, "static_sink_m", config.static_sink_m, "above 0");
  require(config.restitution > 0.0 && config.restitution < 1.0, "restitution", config.restitution,
          "above 0 and below 1");
  require(config.impact_speed_m_s > 0.0, "impact_speed_m_s", config.impact_speed_m_s, "above 0");
  require(config.tangential_damping_ratio >= 0.0, "tangential_damping_ratio",
          config.tangential_damping_ratio, "at least 0");
  height_m_ = config.height_m;
  friction_ = config.friction;
  stiffness_N_m_ = config.static_load_N / config.static_sink_m;
  damping_s_m_ = DampingOfRestitution(config.restitution) / config.impact_speed_m_s;
  tangential_stiffness_N_m_ = 2.0 / 3.0 * stiffness_N_m_;
  tangential_damping_N_s_m_ =
      2.0 * config.tangential_damping_ratio *
      std::sqrt(tangential_stiffness_N_m_ * config.static_load_N / types::kStandardGravity_m_s2);
}

GroundLaw::Result GroundLaw::Force(const Eigen::Vector3d& position_m,
                                   const Eigen::Vector3d& velocity_m_s,
                                   const ContactMemory& memory) const noexcept {
  Result result;
  const double depth = height_m_ - position_m.z();
  if (!(depth > 0.0)) return result;
  const Eigen::Vector2d point = position_m.head<2>();
  const double rate = -velocity_m_s.z();
  const double normal = std::max(0.0, stiffness_N_m_ * depth * (1.0 + damping_s_m_ * rate));
  const double limit = friction_ * normal;
  Eigen::Vector2d stretch = Eigen::Vector2d::Zero();
  if (memory.touches) stretch = point - memory.anchor_m;
  const double elastic = tangential_stiffness_N_m_ * stretch.norm();
  if (elastic > limit) stretch *= limit / elastic;
  Eigen::Vector2d force =
      -tangential_stiffness_N_m_ * stretch - tangential_damping_N_s_m_ * velocity_m_s.head<2>();
  const double size = force.norm();
  if (size > limit) force *= limit / size;
  result.force = {normal, force};
  result.memory = {point - stretch, true};
  if (!(normal > 0.0)) return result;
  result.normal_damping_N_s_m = stiffness_N_m_ * depth * damping_s_m_;
  if (size <= limit) result.tangential_damping_N_s_m = tangential_damping_N_s_m_;
  return result;
}

}  // namespace sinew::world
