// The performance of all joints of a robot (joint_performance.h), and of the robot as a whole.
//
//     MSE       mean over the joints that have samples of theirs
//     energies  sums over the joints
//     drawn_J   int max(sum over the joints of P, 0) dt: on a common supply without a sink, what
//     one
//               joint regenerates is used by the others at that moment, and only the rest is lost
//     lifting   m g dh over the rises of the centre of mass, a lower bound (lifting.h)
//
// net <= drawn_J <= the sum of the joints' electrical_drawn_J. drawn_J needs the electrical power
// of every joint in a tick; where one is lost the tick is lost, and bridged as in energy.h.
// Thread: one. Step is noexcept; allocates in the constructor only.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "components/base/types/joints.h"
#include "components/robot/performance/joint_performance.h"
#include "components/robot/performance/lifting.h"

namespace sinew::performance {

struct RobotPerformanceConfig {
  std::vector<JointPerformanceConfig> joints;  // 1 to types::kMaxJoints
  // All of it, payload included; empty: not known, and there is no lifting bound.
  std::optional<double> mass_kg;
  // Turns of the height below this are noise. Default: four times 2.5 mm, what an encoder step of
  // 0.072 degrees (thesis 3.2.3) in three joints moves a leg of 0.65 m at most (0.65 x 3
  // x 1.26e-3).
  double lift_band_m = 0.01;
};

struct RobotPerformanceOutput {
  int joint_count = 0;
  types::JointArray<JointPerformanceOutput> joint{};
  double mean_square_error_rad2 = 0.0;
  Energies energies;  // sums; electrical_known when all joints know theirs
  double drawn_J = 0.0;
  Coverage drawn;
  bool lifting_known =
      false;  // the mass is known and there was a height; the next two are 0 otherwise
  double rise_m = 0.0;
  double lifting_J = 0.0;
};

class RobotPerformance {
 public:
  // Throws std::invalid_argument: no or too many joints, a figure out of range.
  RobotPerformance(const RobotPerformanceConfig& config, double period_s);

  // samples: of the joints in order; one that is missing was not measured, more are left out.
  // centre_height_m: of the centre of mass, upwards; not a number when not known.
  RobotPerformanceOutput Step(
      std::uint64_t tick, std::span<const JointSample> samples,
      double centre_height_m = std::numeric_limits<double>::quiet_NaN()) noexcept;

 private:
  std::vector<JointPerformance> joints_;
  PowerIntegral drawn_;
  std::optional<LiftingBound> lifting_;
  bool has_height_ = false;
  bool started_ = false;
  std::uint64_t last_tick_ = 0;
};

}  // namespace sinew::performance
