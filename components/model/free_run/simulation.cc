#include "components/model/free_run/simulation.h"

#include <algorithm>
#include <cmath>

namespace sinew::free_run {

namespace {

using identify::StateSegment;

constexpr double kInsideLimit = 0.98;  // of the servo's limit: beyond it the command says nothing
constexpr int kFewestGainRows = 50;

actuator::JointModel Unlimited(actuator::JointModel model) {
  model.motor_torque_limit_Nm = 0.0;  // the recorded drive is what it was
  return model;
}

// False while the bridge is open.
bool Driven(const StateSegment& segment, Eigen::Index i) {
  return segment.supply_voltage.size() == 0 || segment.supply_voltage[i] != 0.0;
}

}  // namespace

Simulation::Simulation(const actuator::JointModel& model, const MakeBody& make_body, double step_s)
    : model_(Unlimited(model)),
      body_(make_body(model_)),
      memory_(static_cast<std::size_t>(model.memory_size())),
      step_s_(model.backlash_rad > 0.0 ? 0.5 * step_s : step_s) {
  shaft_per_input_ = effects::IdealDriveGain(model.constants) / model.constants.gear_ratio;
  back_emf_ = model.constants.back_emf_V_s_rad;
}

void Simulation::WarmUp(const StateSegment& segment, Eigen::Index from, Eigen::Index until) {
  if (memory_.empty()) return;
  if (from == 0) model_.ResetMemory(segment.samples.front(), memory_);
  for (Eigen::Index i = std::max<Eigen::Index>(1, from + 1); i <= until; ++i) {
    model_.Advance(segment.samples[static_cast<std::size_t>(i)], segment.period_s, memory_);
  }
}

void Simulation::Advance(const StateSegment& segment, Eigen::Index i, const Mover& mover) {
  const int steps = std::max(1, static_cast<int>(std::ceil(segment.period_s / step_s_ - 1e-9)));
  const double dt = segment.period_s / steps;
  const bool driven = Driven(segment, i);
  body_->SetSurroundings(segment.samples[static_cast<std::size_t>(i)]);
  for (int k = 0; k < steps; ++k) {
    double input = 0.0;
    if (driven && mover.servo != nullptr) {
      const actuator::Servo& servo = *mover.servo;
      const double error = segment.reference_position[i] + mover.zero_rad - body_->position_rad();
      const double command =
          mover.gain_per_rad * error - servo.velocity_gain_s_rad * body_->velocity_rad_s();
      input = (servo.share_of_supply ? segment.supply_voltage[i] : 1.0) *
              (servo.limit > 0.0 ? std::clamp(command, -servo.limit, servo.limit) : command);
    } else if (driven) {
      input = segment.drive_signal[i];
    }
    if (driven) input -= back_emf_ * body_->motor_velocity_rad_s();
    body_->Step(input * shaft_per_input_, dt);
  }
}

double ServoGain(const StateSegment& segment, const actuator::Servo& servo) {
  double xy = 0.0, xx = 0.0;
  int rows = 0;
  for (Eigen::Index i = 0; i < segment.size(); ++i) {
    double command = segment.drive_signal[i];
    if (servo.share_of_supply) {
      if (segment.supply_voltage[i] == 0.0) continue;
      command /= segment.supply_voltage[i];
    }
    if (servo.limit > 0.0 && std::abs(command) > kInsideLimit * servo.limit) continue;
    const effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
    const double error = segment.reference_position[i] - x.position_rad;
    xy += error * command;
    xx += error * error;
    ++rows;
  }
  return rows >= kFewestGainRows && xx > 0.0 ? std::max(0.0, xy / xx) : 0.0;
}

std::vector<double> ServoGains(const std::vector<StateSegment>& segments,
                               const std::optional<actuator::Servo>& servo) {
  if (!servo) return {};
  std::vector<double> gains;
  for (const StateSegment& segment : segments) {
    if (segment.reference_position.size() == 0) return {};
    if (servo->share_of_supply && segment.supply_voltage.size() == 0) return {};
    gains.push_back(servo->gain_per_rad > 0.0 ? servo->gain_per_rad : ServoGain(segment, *servo));
    if (gains.back() == 0.0) return {};
  }
  return gains;
}

}  // namespace sinew::free_run
