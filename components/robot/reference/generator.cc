#include "components/robot/reference/generator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/robot/reference/blend.h"

namespace sinew::reference {

namespace {

// Brings the speed of the motion that is taken over to rest. At full speed of the rig's published
// motion (1.3 rad/s) that takes 8.6 rad/s2; in half the time 17, and the rig was 8 to 15 mrad
// behind (Matrix.Reference...).
constexpr double kCarry_s = 0.6;
// Extremes of v0 T u (1 - u)^3 (1 + 3 u): the largest excursion is 0.197 v0 T (at u = 0.35), the
// largest acceleration 3.94 v0 / T (at u = 0.24).
constexpr double kCarriedExcursion = 0.197;
constexpr double kCarriedAcceleration = 3.94;

double CarryTime(const Point& from, const Limits& limits) noexcept {
  const double speed_rad_s = std::abs(from.velocity_rad_s);
  if (speed_rad_s == 0.0) return kCarry_s;
  const double gentle_s = 2.0 * kCarriedAcceleration * speed_rad_s / limits.acceleration_rad_s2;
  const double way_rad = from.velocity_rad_s > 0.0 ? limits.position_upper_rad - from.position_rad
                                                   : from.position_rad - limits.position_lower_rad;
  const double fits_s = std::max(way_rad, 0.0) / (kCarriedExcursion * speed_rad_s);
  return std::min(std::max(kCarry_s, gentle_s), fits_s);
}

}  // namespace

Generator::Generator(const GeneratorConfig& config)
    : config_(config), soft_start_s_(config.soft_start_s) {
  if (!config.trajectory) throw std::invalid_argument("no trajectory");
  if (!(config.soft_start_s >= 0.0) || !std::isfinite(config.soft_start_s)) {
    throw std::invalid_argument("soft start is negative or not finite");
  }
  if (!(config.soft_stop_s >= 0.0) || !std::isfinite(config.soft_stop_s)) {
    throw std::invalid_argument("soft stop is negative or not finite");
  }
}

Point Generator::SoftStart(double since_start_s, double soft_start_s) const noexcept {
  return Mix({start_rad_, 0.0, 0.0}, config_.trajectory->At(since_start_s - soft_start_s),
             Blend(since_start_s, soft_start_s));
}

void Generator::Start(double position_rad) noexcept {
  constexpr int kGrid = 100;
  constexpr double kLonger = 1.25;
  constexpr double kLongest_s = 60.0;
  constexpr double kSlack = 1.0 + 1e-9;
  start_rad_ = position_rad;
  carry_s_ = 0.0;
  soft_start_s_ = config_.soft_start_s;
  if (soft_start_s_ == 0.0) return;
  while (soft_start_s_ < kLongest_s) {
    bool fits = true;
    for (int i = 0; i <= kGrid && fits; ++i) {
      const Point p = SoftStart(soft_start_s_ * i / kGrid, soft_start_s_);
      fits = std::abs(p.velocity_rad_s) <= kSlack * config_.limits.velocity_rad_s &&
             std::abs(p.acceleration_rad_s2) <= kSlack * config_.limits.acceleration_rad_s2;
    }
    if (fits) return;
    soft_start_s_ *= kLonger;
  }
}

void Generator::Start(const Point& from) noexcept {
  Start(from.position_rad);
  carried_ = {0.0, from.velocity_rad_s, from.acceleration_rad_s2};
  carry_s_ = CarryTime(from, config_.limits);
}

void Generator::LengthenSoftStart(double soft_start_s) noexcept {
  if (soft_start_s > soft_start_s_) soft_start_s_ = soft_start_s;
}

Point Generator::Carried(double since_start_s) const noexcept {
  if (since_start_s < 0.0 || since_start_s >= carry_s_) return {};
  const double t = carry_s_, u = since_start_s / t;
  const double v = carried_.velocity_rad_s, a = carried_.acceleration_rad_s2;
  return {v * t * (u + u * u * u * (-6.0 + u * (8.0 - 3.0 * u))) +
              0.5 * a * t * t * u * u * (1.0 + u * (-3.0 + u * (3.0 - u))),
          v * (1.0 + u * u * (-18.0 + u * (32.0 - 15.0 * u))) +
              0.5 * a * t * u * (2.0 + u * (-9.0 + u * (12.0 - 5.0 * u))),
          v / t * u * (-36.0 + u * (96.0 - 60.0 * u)) +
              0.5 * a * (2.0 + u * (-18.0 + u * (36.0 - 20.0 * u)))};
}

Point Generator::At(double since_start_s) const noexcept {
  Point point = Reference(since_start_s);
  const Point carried = Carried(since_start_s);
  point.position_rad += carried.position_rad;
  point.velocity_rad_s += carried.velocity_rad_s;
  point.acceleration_rad_s2 += carried.acceleration_rad_s2;
  return point;
}

Point Generator::Reference(double since_start_s) const noexcept {
  if (since_start_s < soft_start_s_) return SoftStart(since_start_s, soft_start_s_);
  const double time_s = since_start_s - soft_start_s_;
  const double end_s = config_.trajectory->duration_s();
  if (time_s < end_s) return config_.trajectory->At(time_s);
  const Point end{config_.trajectory->At(end_s).position_rad, 0.0, 0.0};
  if (time_s - end_s >= config_.soft_stop_s) return end;
  return Mix(config_.trajectory->At(time_s), end, Blend(time_s - end_s, config_.soft_stop_s));
}

bool Generator::Finished(double since_start_s) const noexcept {
  return since_start_s >= soft_start_s_ + config_.trajectory->duration_s() + config_.soft_stop_s;
}

}  // namespace sinew::reference
