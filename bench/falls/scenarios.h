// What happens to the robot in a run, drawn from a number: falls that are provoked, and squats in
// which nobody should find one. Names of links and joints are robots/biped's.
//
// Falls. From kBegin_s on, so that the detector has started and the squats have begun:
//
//     push        80 to 250 N for 0.1 to 0.4 s on the torso, in any horizontal direction
//     lost drive  one of a knee, a hip pitch, an ankle pitch or an ankle roll, for good
//     slip        85 to 100 % of the ground's friction missing, and a nudge of 20 to 60 N for 0.3 s
//
// Not each of them topples the robot: the truth says which did. Squats:
//
//     benchmark   the two squats of the benchmark
//     six         six squats
//     payload     the benchmark with 0.5 to 4 kg in the torso from some time on
//     nudge       the benchmark with three pushes of 5 to 20 N for 0.1 to 0.3 s
//
// Each with one of the controllers in turn. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sim/body_disturbance/schedule.h"

namespace sinew::falls {

enum class Kind { kPush, kLostDrive, kSlip, kBenchmark, kSix, kPayload, kNudge };
inline constexpr int kFallKinds = 3, kSquatKinds = 4;
std::string_view KindName(Kind kind) noexcept;  // "lost drive"

enum class Controller { kPosition, kPid, kComputedTorque };
inline constexpr int kControllers = 3;
std::string_view ControllerName(Controller controller) noexcept;  // "computed torque"

struct Scenario {
  Kind kind = Kind::kPush;
  Controller controller = Controller::kPosition;
  std::uint64_t seed = 0;  // of the sensors' errors, too
  body_disturbance::Schedule schedule{{}, {}};
  double acts_at_s = 0.0;  // when the disturbance begins; 0: none
  double duration_s = 0.0;
  std::string text;  // what was drawn, for people
};

// Kind and controller by number: each kind meets each controller.
Scenario DrawFall(std::uint64_t seed, int number);
Scenario DrawSquats(std::uint64_t seed, int number);

}  // namespace sinew::falls
