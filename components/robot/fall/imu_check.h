// Bounds of an IMU, and which of its samples may be used.
//
// Frame: x forward, y left, z up, in the torso (idl/sensors.idl). Specific force: +g upwards at
// rest.
//
// A sample is lost when it is flagged invalid, holds a value that is not finite, or an angular
// velocity is saturated (then the rotation is not known). It is not new when either triple is equal
// to the last one bit by bit. For a sensor whose noise is at least two steps s of its converter, a
// healthy axis repeats itself with p <= s / (2 sqrt(pi) sigma) = 0.14, three axes with 0.003; a
// frozen time of four samples (0.05 s at 82 Hz) then comes by chance once in 10^10 samples. A
// saturated specific force (impacts pass 2 g) makes only the specific force unusable. Saturation is
// assumed from 0.999 of the range on: a 16-bit converter clips at 0.99997 of it.
#pragma once

#include <Eigen/Core>

#include "components/base/types/angle.h"
#include "components/base/types/gravity.h"

namespace sinew::fall {

inline constexpr double kSaturatedShare = 0.999;  // derived above

// Stated bounds of the IMU. The defaults are those of the data sheet of a consumer part, MPU-6050
// (PS-MPU-6000A revision 3.4, sections 6.1 and 6.2), uncalibrated; they are to be replaced by those
// of the robot's part. tilt_filter.h turns them into gains and an error bound.
struct ImuBounds {
  double force_range_m_s2 = 2.0 * types::kGravity_m_s2;
  double force_bias_m_s2 = 0.7;    // horizontal part: 50 mg on x and on y
  double force_noise_m_s2 = 0.05;  // standard deviation per axis: 400 ug/sqrt(Hz) in 100 Hz
  double rate_range_rad_s = 500.0 * types::kDegree_rad;
  double rate_bias_rad_s = 35.0 * types::kDegree_rad;  // when switched on; 20 deg/s on each axis
  // 20 deg/s over 60 K is 0.33 deg/s/K, with 20 K within an hour (after warming up: the first
  // minutes are not to be faster).
  double rate_drift_rad_s2 = 7.0 * types::kDegree_rad / 3600.0;
  double rate_noise_rad_s = 0.1 * types::kDegree_rad;  // per axis; twice the 0.05 deg/s in 100 Hz
  double rate_scale_error = 0.03;                      // of the reading
};

struct ImuSample {
  bool valid = false;
  Eigen::Vector3d force_m_s2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();
};

struct ImuUse {
  bool rate_usable = false;   // new, finite, not saturated
  bool force_usable = false;  // the same of the specific force; only with rate_usable
};

// Thread: one. Step is noexcept and allocates nothing.
class ImuCheck {
 public:
  // Throws std::invalid_argument for a bound that is not finite or negative, a range of 0.
  explicit ImuCheck(const ImuBounds& bounds);

  ImuUse Step(const ImuSample& sample) noexcept;

 private:
  ImuBounds bounds_;
  bool has_last_ = false;
  ImuSample last_;
};

}  // namespace sinew::fall
