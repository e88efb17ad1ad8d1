// The reference of a whole robot, tick by tick: waits, starts softly from where the joints stand,
// runs.
//
// Time is ticks since the start times the period, so that the same ticks give the same reference.
// It starts start_delay_s after the robot is armed, or at the operator's word while it is armed,
// and stops when the robot is no longer armed. For the first hold_s it asks for the positions that
// were measured when it started: a robot that has to carry itself stands before it moves. Before
// and after it is idle: it asks for nothing, and the points hold the measured positions, 0 for one
// that is not finite. A start from so far away that the way there is not finite ends at once, idle
// and stale, until it is armed or asked anew. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "components/base/types/joints.h"
#include "components/robot/reference/generator.h"

namespace sinew::reference {

enum class StartRule { kArmed, kOperator };

struct RobotReferenceConfig {
  StartRule start = StartRule::kArmed;
  double start_delay_s = 0.0;
  double hold_s = 0.0;
  std::vector<GeneratorConfig> joints;
};

struct RobotReferenceInput {
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;
  double period_s = 0.0;
  bool may_move = false;        // armed, or damped by the provider for a moment
  bool operator_start = false;  // the operator said start since the last step
  bool operator_stop = false;
  int joint_count = 0;
  std::span<const double> position_rad;  // measured, joint_count values
  std::span<const bool> valid;
};

struct RobotReferenceOutput {
  int joint_count = 0;
  bool idle = true;    // nothing is asked for
  bool stale = false;  // a joint was lost when the reference should have started
  bool finished = false;
  types::JointArray<Point> joint{};

  void Exchange(types::StateArchive& archive);  // types/state_archive.h
};

bool AllFinite(const RobotReferenceOutput& output) noexcept;

class RobotReference {
 public:
  // Throws std::invalid_argument for 0 or more than kMaxJoints joints.
  explicit RobotReference(const RobotReferenceConfig& config);
  RobotReferenceOutput Step(const RobotReferenceInput& input) noexcept;
  // Goes on from another generator's reference, which the joints followed until this tick; the next
  // Step is this tick's. What moves passes into the own trajectory, from its beginning; what is at
  // rest (it may have come to its end) is held, and what is idle stays idle, until the operator
  // says start or the robot is armed anew.
  void TakeOver(const RobotReferenceOutput& other, const RobotReferenceInput& input) noexcept;
  bool running() const noexcept { return running_; }
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

 private:
  void Begin(std::uint64_t tick) noexcept;

  std::vector<Generator> joints_;
  StartRule start_;
  double start_delay_s_, hold_s_;
  bool moving_ = false;  // may_move at the last step
  bool asked_ = false;   // the operator said start
  bool running_ = false;
  bool holding_ = false;  // held_, of a reference that was taken over, or measured at the start
  types::JointArray<Point> held_{};
  std::uint64_t session_id_ = 0;
  std::uint64_t allowed_tick_ = 0;  // when it became allowed to start
  std::uint64_t start_tick_ = 0;
};

}  // namespace sinew::reference
