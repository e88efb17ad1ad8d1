// Detects the fall of a biped from its IMU, feet and leg kinematics. Lost sensors count as a fall.
//
// Criteria. A row holds in a tick when its statistic is beyond the threshold; it is a fall when it
// has held without a break for its time. A tick without the statistic neither confirms nor breaks.
//
//     criterion    statistic                     threshold                  for at least
//     tilt         filter's tilt (tilt_filter.h) 30 deg - its error bound   0 (one tick)
//     base height  up . p / h_ref                below 0.8                  20 ms
//     free fall    |specific force|              below 0.5 g                50 ms, feet unloaded
//                                                                           80 ms otherwise
//
// h_ref: the height that the reference asks for at this moment. Lost sensors: IMU, kinematics,
// reference, or all sensors of a foot without a new usable value for more than lost_after_s; ticks
// missing for as long; no specific force usable for coast_s of the filter. The state becomes
// unknown, which is to be treated as a fall. Derivation of all numbers: README.md.
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
