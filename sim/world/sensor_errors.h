// Errors of a row of equal analogue sensors with one converter: the three axes of an accelerometer
// or a gyroscope, the force sensors of the feet.
//
// Of a truth x(t) a sensor reads
//
//     y = clip(round((1 + s) l + b + n, step), range),     l' = 2 pi f (x - l)
//
// l: the truth behind a low pass of first order with the bandwidth f, backward Euler, from the
// truth of the start on. s, b: drawn once from the seed, evenly within their bounds, for each
// sensor of its own. n: white noise of a spectral density d (unit/sqrt(Hz), one-sided), of which
// the low pass leaves the standard deviation
//
//     d sqrt(pi f / 2)         (the noise bandwidth of a low pass of first order is pi f / 2)
//
// a sample. Samples are drawn as independent, which holds for a rate r with exp(-2 pi f / r) << 1:
// 0.07 with 100 Hz at 240 Hz.
//
// Equal seeds give equal readings. SI units. Thread: one. Follow and Read are noexcept and allocate
// nothing.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "components/base/types/angle.h"
#include "components/base/types/gravity.h"

namespace sinew::world {

// All 0: the sensor is ideal.
struct SensorErrors {
  double bandwidth_Hz = 0.0;   // f; 0: no low pass
  double noise_density = 0.0;  // d; needs a bandwidth
  double bias = 0.0;           // largest |b|
  double scale_error = 0.0;    // largest |s|; below 1
  double step = 0.0;           // of the converter; 0: none
  double range = 0.0;          // readings stay within -range to range; 0: none
};

struct ImuErrors {
  SensorErrors force;  // specific force, m/s2
  SensorErrors rate;   // angular velocity, rad/s
};

// MPU-6050, uncalibrated (InvenSense PS-MPU-6000A revision 3.4, sections 6.1 and 6.2, low pass
// DLPFCFG = 2, 2 g and 500 deg/s): noise 400 ug/sqrt(Hz) and 0.005 deg/s/sqrt(Hz), zero-g 50 mg,
// zero rate 20 deg/s, scale 3 %, 16384 and 65.5 steps to a g and a deg/s. Within the bounds of
// components/robot/fall/imu_check.h.
inline constexpr ImuErrors kMpu6050{
    .force = {.bandwidth_Hz = 100.0,
              .noise_density = 400e-6 * types::kStandardGravity_m_s2,
              .bias = 0.05 * types::kStandardGravity_m_s2,
              .scale_error = 0.03,
              .step = types::kStandardGravity_m_s2 / 16384.0,
              .range = 2.0 * types::kStandardGravity_m_s2},
    .rate = {.bandwidth_Hz = 100.0,
             .noise_density = 0.005 * types::kDegree_rad,
             .bias = 20.0 * types::kDegree_rad,
             .scale_error = 0.03,
             .step = types::kDegree_rad / 65.5,
             .range = 500.0 * types::kDegree_rad}};

class SensorRow {
 public:
  // Throws std::invalid_argument, with `what` and the value: a value that is negative or not
  // finite, noise without a bandwidth, a scale error of 1 or more. stream: rows of one seed differ
  // by it.
  SensorRow(std::string_view what, const SensorErrors& errors, std::size_t count,
            std::uint64_t seed, std::uint64_t stream);

  // Draws bias and scale anew, the same ones, and begins with this truth.
  void Reset(std::span<const double> truth) noexcept;
  // The truth of the step of dt_s that ends now.
  void Follow(std::span<const double> truth, double dt_s) noexcept;
  // A sample of each sensor.
  void Read(std::span<double> reading) noexcept;

 private:
  double Uniform() noexcept;  // in (0, 1)
  double Normal() noexcept;

  SensorErrors errors_;
  double deviation_;
  std::uint64_t seed_;
  std::mt19937_64 bits_;
  std::vector<double> low_passed_, bias_, scale_;
};

}  // namespace sinew::world
