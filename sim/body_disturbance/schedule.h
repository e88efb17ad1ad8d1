// Disturbances of a simulated robot on a floating base, tick by tick: payloads, pushes, drives that
// are lost, slippery ground.
//
// An entry acts from at_s to until_s after the start, in ticks k since the start with
//
//     round(at_s / T) <= k < round(until_s / T),    T the period
//
// so that equal ticks give equal disturbances, whatever the clock says. At a time one of each kind
// can act. SI units. Pure; one thread; At allocates for names of links.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "components/robot/provider/simulated_plant.h"

namespace sinew::body_disturbance {

inline constexpr double kForEver_s = std::numeric_limits<double>::infinity();

struct Interval {
  double at_s = 0.0;            // not negative
  double until_s = kForEver_s;  // after at_s
};

// A point mass fixed to a link.
struct Payload {
  Interval when;
  std::string link;
  double mass_kg = 0.0;
  std::array<double, 3> place_m{};  // in the link's frame
};

struct Push {
  Interval when;
  std::string link;
  std::array<double, 3> force_N{};  // world axes
  std::array<double, 3> place_m{};  // in the link's frame
};

// The drive of a joint has no torque.
struct LostDrive {
  Interval when;
  std::string joint;  // of the robot's model
};

// A share of the ground's coefficient of friction is missing.
struct LostFriction {
  Interval when;
  double share = 0.0;  // 0 to 1
};

class Schedule {
 public:
  // Throws std::invalid_argument: an interval that begins before 0 or does not end after its begin,
  // two of a kind at a time, a value that is not finite, a mass below 0, a share outside 0 to 1.
  Schedule(std::vector<Payload> payloads, std::vector<Push> pushes,
           std::vector<LostDrive> lost_drives = {}, std::vector<LostFriction> lost_frictions = {});

  // period_s: positive.
  provider::BodyDisturbance At(std::uint64_t ticks_since_start, double period_s) const;

 private:
  std::vector<Payload> payloads_;
  std::vector<Push> pushes_;
  std::vector<LostDrive> lost_drives_;
  std::vector<LostFriction> lost_frictions_;
};

}  // namespace sinew::body_disturbance
