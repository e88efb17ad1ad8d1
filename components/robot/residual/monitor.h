// Monitors one joint: the torque that its model predicts against the measured one.
//
// Every tick: states in the middle of a sliding window (moving_states.h), the residual
//
//     e = sum of all terms of the model (0 where it is right),   D = its drive terms
//
// and the columns of the test. A moving model does not cover rest, reversals and what follows
// them at once (breakaway, teeth that change sides), so samples slower than rest_velocity, within
// reversal_guard_s of such, or before settle_distance was covered again are left out. Blocks of
// block_s with at least half their samples go into the test (change_test.h).
//
// Columns: every parameter of the model that is not known exactly (prior: its tolerance, at least a
// quarter of its value), and the causes that can be reported: an offset, dry friction, viscous
// friction, a payload (a mass, on a linear axis), the pressure's slope, the drive's own torque.
//
// Thread: one. Step is noexcept; it allocates nothing but in the block that ends the learning.
#pragma once

#include <sinew_idl/residual.h>

#include <optional>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/robot/residual/change_test.h"
#include "components/robot/residual/moving_states.h"

namespace sinew::residual {

// The cause that a change of the residual follows: a constant offset (current sensor, a person
// leaning on the link), the direction of motion (dry friction), velocity (viscous friction),
// gravity and acceleration of a mass at the load cell (payload), the chamber's pressure (its
// sensor, the element's lever), or the drive's torque (torque constant, efficiency).
using Cause = msg::ResidualCause;

// While it is learning, from moving samples what the model leaves, no change can be detected. Not
// excited: at rest or too short in motion, so that a change could not be seen now. Lost: samples
// are lost or are no numbers.
using State = msg::ResidualMonitorState;

struct MonitorConfig {
  double window_s = 0.1;  // of the states' polynomial
  double block_s = 0.125;
  double learn_s = 30.0;          // of motion
  double watch_s = 5.0;           // the test uses at most this much motion
  double false_alarm_h = 1000.0;  // mean time of motion without change until an alarm
  double slack_share = 0.01;      // of the drive torque's rms: smaller changes are not reported
  double slack_Nm = 0.0;          // and not below this
  double drift_1_h = 0.02;        // parameters may wander by this share of their prior in an hour
  double rest_velocity_rad_s = 0.04;
  double reversal_guard_s = 0.06;
  double settle_distance_rad = 0.005;
  double not_excited_after_s = 1.0;  // without a usable block
};

struct MonitorOutput {
  State state = State::kLearning;
  double learnt = 0.0;         // share of learn_s, 0 to 1
  double residual_Nm = 0.0;    // now, as the model file predicts; 0 while there is none
  double rms_Nm = 0.0;         // of its block means over watch_s of motion
  double explained = 0.0;      // share of the drive torque's squares that the model explains there
  double change_rms_Nm = 0.0;  // of what has not been learnt, over watch_s
  double noise_Nm = 0.0;       // that it may have
  double statistic = 0.0;      // of the test, in shares of its threshold: alarm above 1
  bool alarm = false;
  double since_s = 0.0;  // time at which the change is likely to have come; 0: no alarm
  Cause follows = Cause::kNothing;
  Cause rival = Cause::kNothing;  // explains nearly as much: this motion does not distinguish them
  double change = 0.0;            // of the cause's parameter (kg, Nm s/rad, ...)
  double change_error = 0.0;      // standard error
  double follows_share = 0.0;     // share of change_rms_Nm squared that follows it
};

class Monitor {
 public:
  // Throws std::invalid_argument: a model without a drive, a figure out of range, more parameters
  // than kMaxColumns.
  Monitor(const actuator::JointModel& model, const MonitorConfig& config, double period_s);

  // time_s: of this tick. reading: a lost one is not valid.
  MonitorOutput Step(double time_s, const JointReading& reading) noexcept;

  const ChangeTest& test() const noexcept { return *test_; }
  // Ticks from a sample to its use in the test, blocks not counted.
  int delay_ticks() const noexcept { return states_.half_window() + guard_ticks_; }

 private:
  struct Source {
    int term = -1;  // of columns_model_
    int linear = 0;
    Cause cause = Cause::kNothing;
  };
  struct Sample {
    bool usable = false;
    double residual_Nm = 0.0, drive_Nm = 0.0;
    std::array<double, kMaxColumns> column{};
  };

  void AddColumn(int term, int linear, double prior, Cause cause, std::vector<Column>* columns);
  void Evaluate(const effects::JointSample& x, Sample* sample) noexcept;
  bool Moving(const effects::JointSample& x) noexcept;
  void CloseBlock(double time_s) noexcept;

  actuator::JointModel model_;          // as in the file
  actuator::JointModel columns_model_;  // the same terms, and those of the causes behind them
  MonitorConfig config_;
  double period_s_;
  MovingStates states_;
  std::vector<Source> sources_;
  std::optional<ChangeTest> test_;
  std::vector<double> memory_;
  bool memory_known_ = false;

  int guard_ticks_, block_ticks_;
  std::vector<Sample> guard_;  // samples that a reversal may still take back
  int guard_at_ = 0, guard_count_ = 0;
  int blocked_ = 0;           // ticks until a rest or reversal is far enough
  double settled_rad_ = 0.0;  // covered since
  double last_velocity_ = 0.0;

  Block sum_;
  int sum_count_ = 0, sum_ticks_ = 0;
  bool last_block_used_ = false;
  struct Past {
    double end_s = 0.0, squares = 0.0, drive_squares = 0.0;
  };
  std::vector<Past> past_;  // of used blocks
  int past_at_ = 0, past_count_ = 0;
  double last_used_s_ = 0.0;
  bool used_any_ = false, started_ = false;
  double since_s_ = 0.0;
  MonitorOutput output_;
};

}  // namespace sinew::residual
