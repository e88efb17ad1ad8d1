#include "components/reference/generator.h"

#include <cmath>
#include <stdexcept>

#include "components/reference/blend.h"

namespace sinew::reference {

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

void Generator::LengthenSoftStart(double soft_start_s) noexcept {
  if (soft_start_s > soft_start_s_) soft_start_s_ = soft_start_s;
}

Point Generator::At(double since_start_s) const noexcept {
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
