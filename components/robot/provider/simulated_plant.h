// A simulated plant: what acts on links and chambers from outside is set by the simulation's user,
// and what no sensor measures can be read.
//
// Only simulations implement this interface; a plant of hardware has no disturbances to set. A
// state provider reads sim_disturbance and sim_pressure, and writes sim_truth, only for a plant of
// this kind; it reads sim_body_disturbance and writes sim_body_truth only for one with a
// body_truth.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "components/base/types/joints.h"
#include "components/robot/provider/plant.h"

namespace sinew::provider {

// Loads on each joint's link from outside.
struct Disturbance {
  types::JointArray<double> hand_force_N{};      // at the load cell, positive presses down
  types::JointArray<double> extra_payload_kg{};  // in addition to the declared payload
};

// Chambers whose pressure is imposed, whatever relays and gas would make of it.
struct ImposedPressure {
  types::JointArray<bool> imposed{};
  types::JointArray<double> chamber_pressure_bar{};  // gauge
};

// Disturbances of a robot on a floating base from outside: a payload fixed to a link, a push, a
// drive that is lost, ground that becomes slippery. A name that is no link counts as the base
// link's.
struct BodyDisturbance {
  bool operator==(const BodyDisturbance&) const = default;

  std::string payload_link;              // as in the URDF
  double payload_kg = 0.0;               // a point mass; 0: none
  std::array<double, 3> payload_m{};     // in the link's frame
  std::string push_link;                 // as in the URDF
  std::array<double, 3> push_force_N{};  // world axes
  std::array<double, 3> push_m{};        // where, in the link's frame
  std::string lost_drive;                // a joint of the model; empty: none
  double lost_friction = 0.0;            // share of the ground's coefficient, 0 to 1
};

// A payload below 0, a share outside 0 to 1 or a value that is not finite cannot act; a state
// provider passes on the rest.
inline bool IsPossible(const BodyDisturbance& disturbance) noexcept {
  const auto finite = [](const std::array<double, 3>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  return std::isfinite(disturbance.payload_kg) && disturbance.payload_kg >= 0.0 &&
         finite(disturbance.payload_m) && finite(disturbance.push_force_N) &&
         finite(disturbance.push_m) && disturbance.lost_friction >= 0.0 &&
         disturbance.lost_friction <= 1.0;
}

// Base and contacts of a robot on a floating base when the sensors were read, without noise. World
// axes, z up; the base's values are of the origin of the base link.
struct BodyTruth {
  std::array<double, 3> position_m{};
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};  // base to world, unit
  std::array<double, 3> velocity_m_s{};
  std::array<double, 3> angular_velocity_rad_s{};
  // On the robot, of each force sensor of the feet, in the order of BodySensors::foot_force_N.
  std::array<std::array<double, 3>, 8> contact_force_N{};
};

// The state of the gears when the sensors were read, without noise.
struct GearTruth {
  types::JointArray<int> contact{};            // 1: the motor pushes the link up, -1: down, 0: none
  types::JointArray<double> play_angle_rad{};  // motor angle / N - output, from the lower contact
  types::JointArray<double> backlash_rad{};    // 0: the joint has none
};

class SimulatedPlant : public Plant {
 public:
  // Acts from the next Step on, until the next call; Reset ends it. Does not allocate. Values that
  // are not finite: as the plant's own header says.
  virtual void Disturb(const Disturbance& disturbance) = 0;
  // The same for the pressures of its chambers; joints without a chamber are left out.
  virtual void ImposePressure(const ImposedPressure& pressure) = 0;
  // The gears at the last Reset or Step.
  virtual const GearTruth& gear_truth() const = 0;

  // Only a robot on a floating base has these. Acts as Disturb does, but may allocate when the
  // payload changes.
  virtual void DisturbBody(const BodyDisturbance& /*disturbance*/) {}
  // The model has a joint of this name, whose drive can be lost.
  virtual bool HasDrive(const std::string& /*joint*/) const { return false; }
  // The body at the last Reset or Step; nothing for a fixed base.
  virtual const BodyTruth* body_truth() const { return nullptr; }
};

}  // namespace sinew::provider
