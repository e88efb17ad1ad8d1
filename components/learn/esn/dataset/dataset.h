// Training sequences out of recordings of a joint.
//
// A recording goes onto an even grid of the network's period. Position is smoothed and
// differentiated without phase shift; a reference_* input is this measured motion. The target is
// the torque that the drive put out, or the load's. Which samples train is decided by the play
// between motor and output:
//
//     alpha(t) = motor_position / N - position - centre          inside:  |alpha| < backlash / 2 -
//     margin
//
// and by the split into training and test. The network's state runs through all samples.
#pragma once

#include <optional>
#include <vector>

#include "components/base/types/run.h"
#include "components/learn/esn/signals.h"
#include "components/learn/esn/training.h"
#include "components/model/actuator/model.h"

namespace sinew::esn {

enum class Target {
  kDriveTorque,  // drive_torque_Nm: the model's drive terms at the measured current (or voltage),
                 // at the output
  kLoadTorque,   // load_torque_Nm: load_force * link length (5.3), positive presses the link down
};
std::string_view TargetName(Target target);

enum class Region { kAll, kInside, kOutside };

struct DatasetConfig {
  std::vector<Signal> inputs;  // all of the one joint
  Target target = Target::kDriveTorque;
  Region region = Region::kAll;
  double period_s = 1.0 / 240.0;  // of the network's step
  double smoothing_Hz = 12.0;     // cut-off of the zero-phase filter before differentiation, > 0
  // Velocity and acceleration from the motor's angle / N instead of the output's: outside the
  // backlash the two move as one, and the gear makes the motor's encoder N times finer.
  bool derivatives_from_motor = false;
  // Nothing: midway between the extremes that were recorded.
  std::optional<double> play_centre_rad = 0.0;
  double play_margin_rad = 8e-4;  // two counts of a 14 bit encoder
  double region_guard_s = 0.0;    // samples this near to one of the other region are left out
  int blocks = 10;                // each starts with its share of training, the rest is test
  double train_share = 0.7;       // in (0, 1]
};

struct Dataset {
  std::vector<Sequence> sequences;
  long samples = 0;  // on the grid, lost rows left out
  long inside = 0;   // the backlash
  double play_centre_rad = 0.0;
  double duration_s = 0.0;
};

// runs: at least one, of this joint. `joint`: index in messages, for the inputs' names. test_only:
// everything is test. Throws std::invalid_argument: a signal that an input or the target needs is
// missing (named with the input), no backlash in the model though the region asks for one, or
// figures out of range.
Dataset MakeDataset(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                    const DatasetConfig& config, bool test_only = false);

// All joints of a robot side by side: the inputs of joint 0, those of joint 1, ...; a target for
// each joint. A sample is used where all joints use it. runs_of_joint: for each joint of the model
// the same recordings. config.region must be kAll, and no input the play angle. Throws as
// MakeDataset does, and for joints whose recordings differ in length.
Dataset MakeRobotDataset(const std::vector<std::vector<types::Run>>& runs_of_joint,
                         const std::vector<actuator::JointModel>& models,
                         const DatasetConfig& config, bool test_only = false);

// Inputs with their joint, as weights hold them.
std::vector<Input> InputsOfJoint(const std::vector<Signal>& signals, int joint);
// Inputs of joints 0 .. count - 1, in the order of MakeRobotDataset.
std::vector<Input> InputsOfRobot(const std::vector<Signal>& signals, int count);

}  // namespace sinew::esn
