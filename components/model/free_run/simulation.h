// A model of a joint simulated along a recording, sample by sample: by the recorded drive, or by
// the declared servo along the recorded set point.
//
// What moves comes from the caller (Body), so that this module knows no simulation; sim/plant has
// the joint alone (plant::JointAlone). Terms with memory are advanced along the recording up to the
// start. Pure; allocates when it is made; one thread.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/processing.h"

namespace sinew::free_run {

// A simulation of one joint: the joint alone, or the joint in a robot.
class Body {
 public:
  virtual ~Body() = default;
  // At the state of x: position, velocity, motor_position_rad within the play, motor's velocity.
  virtual void Start(const effects::JointSample& x, std::span<const double> memory) = 0;
  virtual void SetSurroundings(const effects::JointSample& x) = 0;
  virtual void Step(double motor_torque_Nm, double dt_s) = 0;
  virtual double position_rad() const = 0;
  virtual double velocity_rad_s() const = 0;
  virtual double motor_velocity_rad_s() const = 0;
};
// The model comes without its torque limit: the recorded drive is what it was. Throws
// std::invalid_argument: a model that cannot be simulated.
using MakeBody = std::function<std::unique_ptr<Body>(const actuator::JointModel& model)>;

// The servo or the recorded drive that moves the model.
struct Mover {
  const actuator::Servo* servo = nullptr;  // null: the recorded drive
  double gain_per_rad = 0.0;               // of the servo
  double zero_rad = 0.0;                   // angle of the model where the encoder reads 0
};

class Simulation {
 public:
  // step_s: of the integration; halved for joints with free play. Throws as make_body.
  Simulation(const actuator::JointModel& model, const MakeBody& make_body, double step_s);

  // Memory as the recording leaves it at its sample `until`, from `from` on.
  void WarmUp(const identify::StateSegment& segment, Eigen::Index from, Eigen::Index until);
  void Start(const effects::JointSample& x) { body_->Start(x, memory_); }
  // From sample i to the next.
  void Advance(const identify::StateSegment& segment, Eigen::Index i, const Mover& mover);

  double position_rad() const { return body_->position_rad(); }
  double velocity_rad_s() const { return body_->velocity_rad_s(); }

 private:
  actuator::JointModel model_;
  std::unique_ptr<Body> body_;
  std::vector<double> memory_;
  double step_s_;
  double shaft_per_input_ = 1.0;
  double back_emf_ = 0.0;  // V per motor rad/s; 0 for drives that are no winding
};

// Gain of a proportional servo by least squares of command against (reference - position), over
// rows inside the limit; 0 when fewer than 50 rows show it.
double ServoGain(const identify::StateSegment& segment, const actuator::Servo& servo);

// The servo's gain in every segment; empty when it is not declared or a segment lacks what it saw.
std::vector<double> ServoGains(const std::vector<identify::StateSegment>& segments,
                               const std::optional<actuator::Servo>& servo);

}  // namespace sinew::free_run
