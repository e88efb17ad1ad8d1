// Torque to start moving at nine angles (5.1.1, Figs 5.2 and 5.3).
//
// The link has stood still; a hand presses on its end, slowly harder, until the shaft turns. With
// (5.1), (5.2):
//
//     T_static = F l + T_gravity cos(angle)
//
// fitted over all trials. The force is read from a parabola through the last 0.2 s, 60 ms before
// the link is gone, where it is greatest; the extreme of noisy rows would be too large. The instant
// is known to one row: the interval of T_static gets that, times the rate of the force, on top of
// the statistical part (a bias that more trials do not remove).
#pragma once

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"

namespace sinew::experiment {

inline constexpr double kBreakawayAngles_deg[] = {-90, -60, -45, -30, 0, 30, 45, 60, 90};

struct BreakawayPlan {
  double angle_rad = 0.0;
  double rest_s = 60.0;
  double rate_N_s = 1.0;        // of the hand
  double hand_N_rad = 150.0;    // its softness
  double play_rad = 0.0464258;  // nominal: the motor stands in its middle
  double longest_s = 12.0;
};

// One trial at one angle.
class BreakawayProtocol : public Protocol {
 public:
  explicit BreakawayProtocol(const BreakawayPlan& plan);
  Start start() const override {
    return {.output_angle_rad = plan_.angle_rad, .rest_s = plan_.rest_s};
  }
  Command Step(const Reading& reading) noexcept override;
  double expected_s() const override { return 4.0; }
  std::string instruction() const override {
    return "press slowly on the end of the link until it gives way, then let go";
  }

 private:
  BreakawayPlan plan_;
  double rest_angle_rad_ = 0.0;
  double hand_rad_ = 0.0;
  double last_s_ = 0.0;
  double broken_s_ = -1.0;
  bool first_ = true;
};

// Nine (or more) trials in one go, for a robot: the motor carries the link from angle to angle,
// lets it rest half of rest_s on the teeth until friction holds it, backs out of them (which slips
// the contacts a little), lets it rest, and the hand presses.
class BreakawayTour : public Protocol {
 public:
  // rest_s: at each angle.
  BreakawayTour(std::vector<double> angles_rad, const BreakawayPlan& plan, double gear_ratio);
  Start start() const override { return {.output_angle_rad = angles_rad_.front() - 0.15}; }
  Command Step(const Reading& reading) noexcept override;
  bool done() const noexcept override { return next_ >= angles_rad_.size(); }
  double expected_s() const override {
    return static_cast<double>(angles_rad_.size()) * (1.5 * plan_.rest_s + 6.0);
  }
  std::string instruction() const override {
    return phase_ == Phase::kPush ? "press slowly on the end of the link until it gives way"
                                  : "hands off the link";
  }

 private:
  enum class Phase { kLift, kSettle, kBackOff, kRest, kPush, kCatch };
  void Enter(Phase phase, double time_s) noexcept;

  std::vector<double> angles_rad_;
  BreakawayPlan plan_;
  double gear_ratio_;
  std::size_t next_ = 0;
  Phase phase_ = Phase::kLift;
  double phase_s_ = 0.0;
  double wanted_rad_ = 0.0;
  double last_s_ = 0.0;
  double held_rad_ = 0.0;
  double hand_rad_ = 0.0;
  bool first_ = true;
};

// One trial's outcome.
struct Breakaway {
  double angle_rad = 0.0;
  double force_N = 0.0;
  double rate_N_s = 0.0;
  double row_s = 0.0;  // time between rows
};
// Every breakaway in a recording: a link at rest under a growing force that gives way.
std::vector<Breakaway> FindBreakaways(const Recording& rows);

// Needs at least 4 trials at 2 or more angles.
Result IdentifyBreakaway(const std::vector<Breakaway>& trials, const RigConstants& rig);

}  // namespace sinew::experiment
