#include "components/robot/fall/imu_check.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::fall {

ImuCheck::ImuCheck(const ImuBounds& bounds) : bounds_(bounds) {
  for (const double value :
       {bounds.force_range_m_s2, bounds.force_bias_m_s2, bounds.force_noise_m_s2,
        bounds.rate_range_rad_s, bounds.rate_bias_rad_s, bounds.rate_drift_rad_s2,
        bounds.rate_noise_rad_s, bounds.rate_scale_error}) {
    if (!std::isfinite(value) || value < 0.0) {
      throw std::invalid_argument("a bound of the IMU is not negative, got " +
                                  std::to_string(value));
    }
  }
  if (bounds.force_range_m_s2 <= types::kGravity_m_s2 || bounds.rate_range_rad_s == 0.0) {
    throw std::invalid_argument("the IMU's ranges are above 1 g and above 0 rad/s, got " +
                                std::to_string(bounds.force_range_m_s2) + " m/s2 and " +
                                std::to_string(bounds.rate_range_rad_s) + " rad/s");
  }
}

ImuUse ImuCheck::Step(const ImuSample& sample) noexcept {
  ImuUse use;
  if (!sample.valid || !sample.force_m_s2.allFinite() || !sample.rate_rad_s.allFinite()) {
    return use;
  }
  const bool same =
      has_last_ && (sample.force_m_s2 == last_.force_m_s2 || sample.rate_rad_s == last_.rate_rad_s);
  has_last_ = true;
  last_ = sample;
  const double rate_rad_s = sample.rate_rad_s.cwiseAbs().maxCoeff();
  use.rate_usable = !same && rate_rad_s < kSaturatedShare * bounds_.rate_range_rad_s;
  const double force_m_s2 = sample.force_m_s2.cwiseAbs().maxCoeff();
  use.force_usable = use.rate_usable && force_m_s2 < kSaturatedShare * bounds_.force_range_m_s2;
  return use;
}

}  // namespace sinew::fall
