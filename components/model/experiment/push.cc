#include "components/model/experiment/push.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/types/control_mode.h"

namespace sinew::experiment {
namespace {

constexpr double kBeyond_N = 2.0;  // past the force that moved the link: it stands at the end
constexpr double kLongestDown_s = 4.0;
constexpr double kLongestUp_s = 4.0;

}  // namespace

PushProtocol::PushProtocol(const PushPlan& plan) : plan_(plan) {
  if (!(plan.first_bar >= plan.last_bar) || !(plan.last_bar >= 0.0) || !(plan.duration_s > 0.0) ||
      plan.shut_every < 0 || !(plan.hand_N_rad > 0.0) || !(plan.hand_speed_rad_s > 0.0)) {
    throw std::invalid_argument(
        "pushes: pressures must fall, duration and the hand's numbers must be positive");
  }
}

Command PushProtocol::Step(const Reading& reading) noexcept {
  Command command;
  command.drive = types::ControlMode::kPosition;  // holds the motor
  if (reading.time_s >= plan_.duration_s) {
    done_ = true;
    return command;
  }
  const double dt_s = reading.time_s - last_s_;
  last_s_ = reading.time_s;
  const double angle_rad = reading.output_angle_rad;
  const double velocity_rad_s = reading.output_velocity_rad_s;
  const double in_phase_s = reading.time_s - phase_s_;
  double hand_speed_rad_s = 0.0;
  switch (phase_) {
    case Phase::kPause:
      hand_rad_ = angle_rad;
      if (in_phase_s > plan_.pause_s) {
        phase_ = Phase::kDown;
        phase_s_ = reading.time_s;
        moving_force_N_ = 0.0;
        moved_s_ = 0.0;
        start_rad_ = angle_rad;
        ++pushes_;
      }
      break;
    case Phase::kDown: {
      hand_speed_rad_s = -plan_.hand_speed_rad_s;
      if (velocity_rad_s < -kMovedSpeed_rad_s) {
        moving_force_N_ += (reading.load_force_N - moving_force_N_) * (moved_s_ > 0.0 ? 0.1 : 1.0);
        moved_s_ = reading.time_s;
      }
      const bool ended = moved_s_ > 0.0 && reading.time_s - moved_s_ > 0.1 &&
                         reading.load_force_N > moving_force_N_ + kBeyond_N;
      if (ended || reading.load_force_N > plan_.largest_hand_N - 0.5 ||
          in_phase_s > kLongestDown_s) {
        phase_ = Phase::kUp;
        phase_s_ = reading.time_s;
      }
      break;
    }
    case Phase::kUp:
      hand_speed_rad_s = plan_.hand_speed_rad_s;
      if ((plan_.hand_N_rad * (angle_rad - hand_rad_) < -0.5 &&
           std::abs(velocity_rad_s) < kMovedSpeed_rad_s) ||
          in_phase_s > kLongestUp_s) {
        phase_ = Phase::kPause;
        phase_s_ = reading.time_s;
      }
      break;
  }
  if (phase_ != Phase::kPause) {
    hand_rad_ += hand_speed_rad_s * dt_s;
    command.hand_force_N = std::clamp(plan_.hand_N_rad * (angle_rad - hand_rad_) +
                                          plan_.hand_N_s_rad * (velocity_rad_s - hand_speed_rad_s),
                                      0.0, plan_.largest_hand_N);
  }
  const double planned_bar =
      plan_.first_bar - (plan_.first_bar - plan_.last_bar) * reading.time_s / plan_.duration_s;
  command.vent_open = reading.reservoir_pressure_bar > planned_bar;
  command.valve_open =
      plan_.shut_every == 0 || phase_ == Phase::kPause || pushes_ % plan_.shut_every != 0;
  return command;
}

}  // namespace sinew::experiment
