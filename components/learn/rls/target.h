// The target equation of the adaptation: which torque the network should have predicted.
//
// A network is asked for the torque of the *reference* motion; what can be measured is the torque
// of the motion that was. So the model file's balance carries the one to the other (computed
// torque; equation error):
//
//     W phi(c - 1) = y(c),    y(c) = tau(c) + M(reference of c - 1) - M(motion at c)
//
//   phi(c - 1)  features with which the command of tick c - 1 was made
//   tau(c)      drive torque at the output that the motor put out under that command
//   M(x)        drive torque that the model file asks for at x: position, velocity, acceleration,
//               with the pressure, load, payload and temperature measured at c (InverseDynamics)
//
// tau - M(motion) is what the model does not know; M(reference) the rest. Without this carrying
// over, tau is prediction plus feedback, and learning it integrates the feedback once more. On the
// surrogate rig (30 degree sine, forgetting 0.999, prior precision 1) that swings: 32 mrad rms of
// tracking error against 3 with it and 2 without adaptation.
//
// Velocity and acceleration come from a parabola through 2 h + 1 positions around tick c (Savitzky
// and Golay 1964), so the equation lags by h ticks; learning has time. With `carry_over` off, h is
// 0 and y(c) = tau(c).
//
// One thread. No memory is taken in Push.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "components/base/types/joints.h"
#include "components/learn/esn/inverse_dynamics.h"
#include "components/learn/esn/signals.h"
#include "components/learn/esn/weights.h"
#include "components/model/actuator/model.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::rls {

struct TargetConfig {
  bool carry_over = true;
  int half_window_ticks = 8;  // h, 1 .. 100
  bool motion_from_motor =
      true;  // velocity and acceleration of the motor's angle / N, else of the output's
  double smoothing_rad_s = 0.05;                           // of the model's dry friction, > 0
  std::optional<esn::StanceConfig> stance = std::nullopt;  // rigid bodies of a biped, in M
};

// Data of one tick. Arrays are by joint.
struct TickData {
  std::uint64_t tick = 0;
  double period_s = 0.0;
  bool usable = false;  // nothing was lost, and the command of the tick before was a torque command
  bool positions_valid = false;  // nothing but positions matters in the rest of a window
  int network = 0;               // of the features: 0 SEA, 1 PEA
  Eigen::Ref<const Eigen::VectorXd> features;  // of the tick before
  types::JointArray<double> position_rad{};
  types::JointArray<double> motor_position_rad{};
  types::JointArray<double> drive_torque_Nm{};
  esn::Frame measured{};  // pressure, load, payload, temperature
};

class TargetEquation {
 public:
  // The weights name the features: reference position, velocity and acceleration of every
  // output's joint are needed for carrying over. Throws std::invalid_argument naming what is
  // missing or out of range.
  TargetEquation(const TargetConfig& config, const actuator::RobotModel& robot,
                 const std::optional<esn::Weights>& sea, const std::optional<esn::Weights>& pea);

  void Reset() noexcept;

  struct Sample {
    int network;
    Eigen::Ref<const Eigen::VectorXd> features;
    Eigen::Ref<const Eigen::VectorXd> target_Nm;
    double fastest_velocity_rad_s;  // of reference and motion; 0 without carrying over
  };
  // Nothing: no whole window yet, or something in it was not usable. Valid until the next call.
  std::optional<Sample> Push(const TickData& data) noexcept;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

 private:
  struct Network {
    int outputs = 0;
    int features = 0;
    double input_limit = 0.0;
    esn::Normalisation normalisation;
    // Index of the feature that is the reference's position, velocity, acceleration of each
    // output's joint.
    std::vector<std::array<int, 3>> reference;
  };
  struct Slot {
    bool usable = false;
    bool positions_valid = false;
    int network = 0;
    Eigen::VectorXd features;
    types::JointArray<double> position_rad{};
    types::JointArray<double> motor_rad{};  // over the gear
    types::JointArray<double> drive_torque_Nm{};
    esn::Frame measured;

    void Exchange(types::StateArchive& archive);
  };

  const Slot& At(int ticks_ago) const noexcept;
  bool CarryOver(const Slot& centre, const Network& network, double period_s,
                 double* fastest_rad_s) noexcept;

  TargetConfig config_;
  int half_;
  std::vector<double> gear_ratio_;
  std::array<std::optional<Network>, 2> networks_;
  std::vector<Slot> ring_;
  std::size_t newest_ = 0;
  int filled_ = 0;
  std::uint64_t last_tick_ = 0;
  std::optional<esn::InverseDynamics> at_reference_;
  std::optional<esn::InverseDynamics> at_motion_;
  Eigen::VectorXd features_;
  Eigen::VectorXd target_Nm_;
};

}  // namespace sinew::rls
