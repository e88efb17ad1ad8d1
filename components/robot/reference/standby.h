// The reference of a standby: its owner's, until the standby itself is heard; then it goes on from
// there.
//
// While another generator is the owner, its last points are carried on to the present tick (they
// come a tick late), so that a reader that hears the standby next hears no step. Then the own
// generator takes over (RobotReference::TakeOver). Where the last points are old, as after a stop
// of this process, nobody knows where the motion is: nothing is asked for until the robot is armed,
// or its operator asks, again. Thread: one. noexcept, allocates nothing.
#pragma once

#include <cstdint>

#include "components/robot/reference/robot_reference.h"

namespace sinew::reference {

class Standby {
 public:
  // Throws as RobotReference.
  explicit Standby(const RobotReferenceConfig& config) : own_(config) {}

  // The owner's reference of a tick of the running session. One that is not finite is left out.
  void Follow(std::uint64_t tick, const RobotReferenceOutput& owner) noexcept;
  // owner_heard: another one is the owner. What is published in this tick.
  RobotReferenceOutput Step(const RobotReferenceInput& input, bool owner_heard) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

 private:
  RobotReferenceOutput CarriedOn(const RobotReferenceInput& input) const noexcept;

  RobotReference own_;
  RobotReferenceOutput owner_;
  std::uint64_t owner_tick_ = 0;
  bool follows_ = false;
};

}  // namespace sinew::reference
