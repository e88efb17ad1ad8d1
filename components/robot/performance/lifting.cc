#include "components/robot/performance/lifting.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/robot/performance/sliding_window.h"

namespace sinew::performance {

double LiftingWork_J(double mass_kg, double rise_m, double gravity_m_s2) noexcept {
  return mass_kg * gravity_m_s2 * std::max(0.0, rise_m);
}

LiftingBound::LiftingBound(double mass_kg, double band_m, double gravity_m_s2)
    : mass_kg_(mass_kg), band_m_(band_m), gravity_m_s2_(gravity_m_s2) {
  for (const double value : {mass_kg, band_m, gravity_m_s2}) {
    if (!std::isfinite(value) || value <= 0.0) {
      throw std::invalid_argument("mass, band and gravity are positive, got " +
                                  std::to_string(value));
    }
  }
}

void LiftingBound::Step(double height_m) noexcept {
  if (!IsUsable(height_m)) {
    ++lost_;
    return;
  }
  if (!started_) {
    started_ = true;
    low_m_ = height_m;
  }
  if (rising_) {
    high_m_ = std::max(high_m_, height_m);
    if (height_m < high_m_ - band_m_) {
      past_m_ += high_m_ - low_m_;
      rising_ = false;
      low_m_ = height_m;
    }
  } else {
    low_m_ = std::min(low_m_, height_m);
    if (height_m > low_m_ + band_m_) {
      rising_ = true;
      high_m_ = height_m;
    }
  }
}

double LiftingBound::rise_m() const noexcept {
  return past_m_ + (rising_ ? high_m_ - low_m_ : 0.0);
}

}  // namespace sinew::performance
