// Pushes through the play: the motor stands still, the chamber holds the link against the upper
// contact, a hand presses it slowly down to the lower one and lets it come back, while the pressure
// falls (5.1.2). Two experiments are read from it.
//
// Moving friction (5.4): while the link moves inside the play, with s = +1 down and -1 up,
//
//     F l = K P - T_gravity cos q + s T_dyn - J d2q/dt2
//
// Means over windows of each stroke give K, T_dyn, T_gravity and J; a stroke is a trial. The means
// are weighted with a Hann window w: w and dw/dt vanish at its ends, so that the mean of d2q/dt2
// is that of q with d2w/dt2, and nothing is differentiated (modulating functions: Shinbrot, Trans.
// ASME 79 (1957) 547). What noise of the angle leaves in it would bias J, and with J the gas
// stiffness, so that two halves of the rows are each other's instruments. Published: strokes down
// only, with T_gravity known from `breakaway`.
//
// Stiffness (5.5): the secant of a push is the torque that takes the link through the play, over
// the play. A push whose link had not come back passes nothing, and its secant is 0: the chamber no
// longer overcomes friction. The differential stiffness of the gas is the slope of F l over the
// angle inside the strokes, chamber shut or joined to the reservoir: several windows a stroke, with
// acceleration and time (a falling pressure) as further columns, each stroke its own level.
#pragma once

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"
#include "components/model/experiment/strokes.h"

namespace sinew::experiment {

struct PushPlan {
  double first_bar = 6.0;
  double last_bar = 2.5;
  double duration_s = 120.0;
  int shut_every = 0;  // every n-th push has the chamber shut; 0: none
  double hand_N_rad = 60.0;
  double hand_N_s_rad = 2.0;
  double hand_speed_rad_s = 0.15;  // of the hand's own motion
  double largest_hand_N = 12.0;
  double pause_s = 0.25;
};

class PushProtocol : public Protocol {
 public:
  explicit PushProtocol(const PushPlan& plan);  // throws std::invalid_argument
  Start start() const override {
    return {.pressure_bar = plan_.first_bar, .rest_s = 0.5, .rotor_locked = true};
  }
  Command Step(const Reading& reading) noexcept override;
  double expected_s() const override { return plan_.duration_s; }
  std::string instruction() const override {
    return "press the link slowly through the play and let it come back, every three seconds";
  }

 private:
  enum class Phase { kPause, kDown, kUp };
  PushPlan plan_;
  Phase phase_ = Phase::kPause;
  double phase_s_ = 0.0;
  double last_s_ = 0.0;
  double hand_rad_ = 0.0;
  double moving_force_N_ = 0.0;
  double moved_s_ = 0.0;
  double start_rad_ = 0.0;
  int pushes_ = 0;
};

Result IdentifyMovingFriction(const Recording& rows, const RigConstants& rig);
Result IdentifyStiffness(const Recording& rows, const RigConstants& rig);

// Slope of F l over the angle inside the shut (or open) strokes, scaled to 6 bar like the gas
// stiffness, at equal acceleration and time. Of rows without noise, whose force is only what the
// gas bears: the true value.
double MeanSlope(const Recording& rows, const Play& play, bool valve_open, double length_m);

}  // namespace sinew::experiment
