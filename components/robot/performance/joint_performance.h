// Performance of a joint: how well it follows its reference and what it takes, tick by tick.
//
//     e(t)       = q_ref(t) - q(t)                                          thesis (7.6)
//     RMSE_W(t)  = sqrt( 1/|W| sum_{t_i in [t - W, t]} e(t_i)^2 ), W = 1.5 s           (7.7)
//     MSE        = 1/n sum e(t_i)^2, over all n samples since the beginning
//
// Both ends belong to the window, so |W| = W / period + 1 samples when none is lost (361 at 240
// Hz). A lost sample (missing tick, no number) is left out of the sum and of |W|; window_share says
// how many of the window's ticks were measured. An RMSE of few samples is weaker, not wrong: the
// caller decides what share it asks for. Nothing is carried over from an older value. Energies, and
// how they bridge lost samples: energy.h. Rounding: sliding_window.h, compensated_sum.h. Thread:
// one. Step is noexcept; allocates in the constructor only.
#pragma once

#include <cstdint>
#include <limits>

#include "components/robot/performance/compensated_sum.h"
#include "components/robot/performance/energy.h"
#include "components/robot/performance/sliding_window.h"

namespace sinew::performance {

inline constexpr double kWindow_s = 1.5;  // W of (7.7)

struct JointPerformanceConfig {
  double window_s = kWindow_s;  // at least a period
  double bridge_s = kBridge_s;
  MotorConstants motor;
};

// A linear joint: m, m/s, N for rad, rad/s, N m. Not a number: not measured in this tick.
struct JointSample {
  double reference_rad = std::numeric_limits<double>::quiet_NaN();
  double position_rad = std::numeric_limits<double>::quiet_NaN();
  double velocity_rad_s = std::numeric_limits<double>::quiet_NaN();
  double torque_Nm = std::numeric_limits<double>::quiet_NaN();  // of the drive, at the joint
  double current_A = std::numeric_limits<double>::quiet_NaN();  // of the motor
};

// As of the last tick. A value that is not known is 0.
struct JointPerformanceOutput {
  bool error_known = false;  // this tick
  double error_rad = 0.0;
  bool rms_known = false;  // the window has a sample
  double sliding_rms_rad = 0.0;
  double window_share = 0.0;            // measured ticks / ticks of the window, 0 to 1
  double mean_square_error_rad2 = 0.0;  // known when error_samples > 0
  std::uint64_t error_samples = 0;
  std::uint64_t error_lost = 0;      // ticks without an error
  std::uint64_t repeated_ticks = 0;  // steps whose tick is not after the last one: left out
  Energies energies;
  Coverage mechanical, electrical;  // of the energies
};

class JointPerformance {
 public:
  // Throws std::invalid_argument: a figure out of range (energy.h, window shorter than a period).
  JointPerformance(const JointPerformanceConfig& config, double period_s);

  JointPerformanceOutput Step(std::uint64_t tick, const JointSample& sample) noexcept;

  // Power in the last tick: R I^2 + Kt I N w; not a number where it is not known.
  double electrical_W() const noexcept { return energy_.electrical_W(); }

 private:
  SlidingWindow squares_;
  JointEnergy energy_;
  CompensatedSum square_sum_;
  bool started_ = false;
  std::uint64_t last_tick_ = 0;
  JointPerformanceOutput output_;
};

}  // namespace sinew::performance
