// Detects the fall of a biped from its IMU, feet and leg kinematics. Lost sensors count as a fall.
//
// A fall, as defined here (of the truth, not of an estimate):
//
//     tilt         the torso is tilted by more than 30 degrees, or
//     base height  the base is below 0.8 of its nominal height, or
//     free fall    more than half of the weight is carried by nothing.
//
// Nominal height: where the reference says that the base should be at this moment, an input. Fixed
// at the standing height it would make every squat a fall (0.25 m of 0.65 m is 0.38). A base that
// follows its reference h_ref = c + a cos(w t) late by d has, at worst, the ratio
// 1 - a w d / sqrt(c^2 - a^2): with the benchmark squat (c 0.45, a 0.2 m, 0.2 Hz) and d = 50 ms
// 0.97; 0.8 is reached at d = 0.32 s.
//
// Criteria. A row holds in a tick when its statistic is beyond the threshold; it is a fall when it
// has held without a break for its time. A tick without the statistic neither confirms nor breaks.
//
//     criterion    statistic                     threshold                  for at least
//     tilt         filter's tilt (tilt_filter.h) 30 deg - its error bound   0 (one tick)
//     base height  up . p / h_ref                below 0.8                  20 ms
//     free fall    |specific force|              below 0.5 g                50 ms with feet
//     unloaded,
//                                                                           80 ms otherwise
//
// - Tilt: at 30 degrees of truth the filter shows at least 30 minus its bound (7.3 with the
//   defaults), so no fall is missed, however slow. No alarm while the true tilt is below 30 minus
//   twice the bound (15 degrees); healthy motion must stay below. The filter is smooth: one tick
//   suffices. Latest detection: the filter's delay (15 ms) and a tick.
// - Base height: p, the vector from the sole of the loaded foot to the base by leg kinematics, in
//   the IMU's frame, along the filter's up. An encoder step (0.072 degrees, thesis 3.2.3) moves the
//   base by 2.5 mm at most, 1 % at the lowest reference; a squat's tracking error by 3 %. 20 ms are
//   at least two ticks from 50 Hz up, so that one corrupt position is no fall; a base that sinks at
//   1 m/s sinks by 20 mm meanwhile.
// - Free fall: healthy motion stays above 0.5 g as long as the reference lowers the base with less
//   than 0.4 g (bias, noise and tracking have the rest): the benchmark squat has 0.03 g; 0.2 m of
//   amplitude reach 0.4 g at 0.7 Hz. Rebounds after an impact ring with 20 Hz or more and are below
//   for 25 ms at a time: twice that. Feet are unloaded when all eight sensors are there and sum to
//   less than 0.2 of the weight; without that evidence the specific force alone must hold for 80
//   ms, which with a tick stays below 100. Fallen meanwhile: 12 mm and 31 mm.
//
// Lost sensors. IMU, kinematics, reference, or all sensors of a foot without a new usable value for
// more than lost_after_s = 50 ms; ticks missing for as long; no specific force usable for coast_s
// of the filter. In 50 ms the tilt moves by at most g / l sin(30 deg) t^2 / 2 = 0.35 degrees more
// than with the last angular velocity held, and half of the 100 ms are left. The state becomes
// unknown, which is to be treated as a fall. The torso's orientation as the IMU itself estimates it
// is no input. That the caller no longer calls is for a watchdog to find.
//
// States. Unknown from the start until the filter has started and all sensors are there; then
// upright. Falling, and unknown by loss, stay until Reset: motors do not come back by themselves.
// motors_off is true in every state but upright.
//
// Frames, signs: imu_check.h, feet.h. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "components/robot/fall/feet.h"
#include "components/robot/fall/imu_check.h"
#include "components/robot/fall/tilt_filter.h"

namespace sinew::fall {

enum class FallState { kUnknown, kUpright, kFalling };

enum class Criterion { kNone, kTilt, kBaseHeight, kFreeFall };

// Why the state is unknown.
enum class Unknown {
  kNone,
  kStarting,
  kImu,
  kSpecificForce,
  kKinematics,
  kReference,
  kFeet,
  kTicks
};
std::string_view UnknownName(Unknown unknown) noexcept;  // "specific_force"

struct FallConfig {
  TiltConfig tilt;               // tilt.limit_rad: the 30 degrees
  double height_share = 0.8;     // of the reference
  double free_fall_share = 0.5;  // of g
  double unloaded_share = 0.2;   // of the weight
  double mass_kg = 17.1;         // thesis: without the supply
  double height_hold_s = 0.020;
  double unloaded_hold_s = 0.050;
  double free_fall_hold_s = 0.080;
  double lost_after_s = 0.050;
};

struct FallInput {
  static constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();

  std::uint64_t tick = 0;
  ImuSample imu;
  FootForces feet;
  // p: from the sole of the foot that carries more (feet.h) to the base, in the IMU's frame; not a
  // number: not known. Where no foot carries anything, of the last one that did.
  Eigen::Vector3d foot_to_base_m = Eigen::Vector3d::Constant(kNotKnown);
  double reference_height_m = kNotKnown;  // of the base above the ground, positive
};

struct FallOutput {
  FallState state = FallState::kUnknown;
  Criterion criterion = Criterion::kNone;  // kFalling: the one that was first
  Unknown unknown = Unknown::kStarting;    // kUnknown: why
  // kFalling: first tick in which the criterion held; kUnknown by loss: first tick that was lost.
  std::uint64_t since_tick = 0;
  bool motors_off = true;
  // As of this tick; 0 where not known.
  double tilt_rad = 0.0;
  double base_height_m = 0.0;  // vertical
  bool share_known = false;
  double height_share = 0.0;  // of the reference
  FootLoads feet;
  std::uint64_t repeated_ticks = 0;  // steps whose tick is not after the last one: left out
};

class FallDetector {
 public:
  // Throws std::invalid_argument: a figure that is not positive, a share above 1, as TiltFilter; an
  // IMU so coarse that its error bound is half of the limit or more (an upright torso could then be
  // an alarm); lost_after_s below a period; times that leave no tick of the 100 ms.
  FallDetector(const FallConfig& config, double period_s);

  FallOutput Step(const FallInput& input) noexcept;
  // After the robot was set up again: starts anew.
  void Reset() noexcept;

  const TiltFilter& filter() const noexcept { return filter_; }
  double tilt_threshold_rad() const noexcept { return tilt_threshold_rad_; }

 private:
  static constexpr std::size_t kSources = 4;
  struct Hold {
    bool holds = false;
    std::uint64_t since_tick = 0;
  };

  double Since_s(std::uint64_t tick) const noexcept;
  // known: this tick has the statistic. True when it has been beyond its threshold for for_s.
  bool Holds(Hold* hold, bool known, bool beyond, double for_s) noexcept;
  void FindFall(const FallInput& input, const ImuUse& use) noexcept;
  void FindLoss(std::uint64_t missing) noexcept;
  void Lose(Unknown unknown, std::uint64_t since_tick) noexcept;

  FallConfig config_;
  double period_s_;
  TiltFilter filter_;
  ImuCheck check_;
  double tilt_threshold_rad_;
  bool has_tick_ = false;
  std::uint64_t tick_ = 0;
  Hold tilt_, height_, unloaded_, free_fall_;
  // Last tick with a usable value: IMU, kinematics, reference, feet.
  std::array<std::uint64_t, kSources> seen_tick_{};
  FallOutput output_;
};

}  // namespace sinew::fall
