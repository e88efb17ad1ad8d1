#include "sim/plant/joint_body.h"

#include <algorithm>
#include <memory>
#include <span>

#include "components/base/types/control_mode.h"
#include "sim/plant/single_joint.h"

namespace sinew::plant {
namespace {

class JointBody final : public free_run::Body {
 public:
  explicit JointBody(const actuator::JointModel& model) : joint_(model, JointPlantConfig{}) {}

  void Start(const effects::JointSample& x, std::span<const double> memory) override {
    joint_.Reset(x.position_rad, x.velocity_rad_s);
    JointPlant& plant = joint_.plant();
    const double ratio = plant.model().constants.gear_ratio;
    const double play = 0.5 * plant.model().backlash_rad;
    // An unknown zero of an encoder must not make the teeth overlap.
    const double gap = std::clamp(x.motor_position_rad / ratio - x.position_rad, -play, play);
    plant.SetRotor(ratio * (x.position_rad + gap), x.motor_velocity_rad_s);
    plant.SetMemory(memory);
  }
  void SetSurroundings(const effects::JointSample& x) override {
    joint_.plant().SetSurroundings(x);
  }
  void Step(double motor_torque_Nm, double dt_s) override {
    DriveCommand command;
    command.mode = types::ControlMode::kTorque;
    command.motor_torque_Nm = motor_torque_Nm;
    joint_.plant().SetCommand(command);
    joint_.Step(dt_s);
  }
  double position_rad() const override { return joint_.position_rad(); }
  double velocity_rad_s() const override { return joint_.velocity_rad_s(); }
  double motor_velocity_rad_s() const override { return joint_.plant().motor_velocity_rad_s(); }

 private:
  SingleJoint joint_;
};

}  // namespace

free_run::MakeBody JointAlone() {
  return [](const actuator::JointModel& model) { return std::make_unique<JointBody>(model); };
}

}  // namespace sinew::plant
