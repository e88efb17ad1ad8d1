// The reference of a joint from the moment it may move: a soft start from where it stands, the
// trajectory, a soft stop at its end. A function of the time since the start, so that two runs
// agree.
//
// With T the soft start and D the trajectory's duration (w: blend.h):
//
//     t < T           q0 + w(t / T) (x(t - T) - q0)      at rest at q0, on the trajectory at T
//     T <= t < T + D  x(t - T)
//     later           from x to rest at x(D) within the soft stop
//
// Start chooses a longer soft start when the way is so long that the limits would be passed; the
// positions in between lie between q0 and the trajectory. Thread: one. Allocates only when made.
#pragma once

#include "components/robot/reference/limits.h"
#include "components/robot/reference/trajectory.h"

namespace sinew::reference {

struct GeneratorConfig {
  TrajectoryPtr trajectory;
  double soft_start_s = 2.0;
  double soft_stop_s = 1.0;
  Limits limits;
};

class Generator {
 public:
  // Throws std::invalid_argument for a missing trajectory or a negative time.
  explicit Generator(const GeneratorConfig& config);

  // The joint stands at position_rad; time counts from here.
  void Start(double position_rad) noexcept;
  // The same for a joint that moves: its velocity and acceleration pass into those of the soft
  // start within kCarry_s, sooner where the position limit in its way is too near for that,
  // later where it would take more than half of the acceleration limit:
  //
  //     c(u) = v0 T u (1 - u)^3 (1 + 3 u) + a0 T^2 / 2 u^2 (1 - u)^3,  u = t / T
  //
  // is added, the quintic with value 0, slope v0 and curvature a0 at 0 and nothing of each at T.
  void Start(const Point& from) noexcept;
  // So that all joints of a robot reach their trajectories together. Right after Start.
  void LengthenSoftStart(double soft_start_s) noexcept;
  Point At(double since_start_s) const noexcept;

  double soft_start_s() const noexcept { return soft_start_s_; }  // as chosen by Start
  // Past the trajectory and its soft stop: at rest for good.
  bool Finished(double since_start_s) const noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

 private:
  Point SoftStart(double since_start_s, double soft_start_s) const noexcept;
  Point Carried(double since_start_s) const noexcept;
  Point Reference(double since_start_s) const noexcept;

  GeneratorConfig config_;
  double start_rad_ = 0.0;
  double soft_start_s_ = 0.0;
  Point carried_;  // velocity and acceleration at the start
  double carry_s_ = 0.0;
};

}  // namespace sinew::reference
