// From a recording to the states that effects read: position filtered without phase, its
// derivatives, the drive, pressure and the rest, on an even grid; and which samples a moving model
// may be fitted to. Parallel filtering (Gautier 1997: Dynamic identification of robots with power
// model): later the drive and every column of regressors go through one and the same second filter,
// so that its distortion cancels. Pure; allocates; throws std::invalid_argument for recordings and
// options that cannot be used.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/processing_settings.h"
#include "components/model/identify/uniform.h"

namespace sinew::identify {

// Why a row says nothing about a moving joint; of several reasons the first.
enum class RowUse : char {
  kUsed,
  kHole,      // rows were lost, or the row was interpolated
  kBorder,    // of a piece: the filters begin or end there
  kRest,      // slower than the rest velocity, or too slow to know the direction
  kReversal,  // within the guard around rest and reversals
  kContact,   // near a touch of the teeth, or no tooth surely carries
  kSettling,  // within the settling distance after rest
};

// The states of one piece of a recording, at the full rate.
struct StateSegment {
  int run = 0;
  double start_s = 0.0;
  double period_s = 0.0;
  std::vector<effects::JointSample> samples;
  Eigen::VectorXd drive_input;   // as measured, not filtered; back-EMF taken off
  Eigen::VectorXd drive_rate;    // of drive_input behind the low-pass
  Eigen::VectorXd drive_signal;  // what the recording holds: drive_input without that
  // Signals that a servo saw, row by row; empty where they were not recorded.
  Eigen::VectorXd reference_position, supply_voltage;
  std::vector<char> valid;    // 0: inside a hole of lost rows
  std::vector<char> usable;   // moving, away from reversals, borders and holes
  std::vector<char> at_rest;  // slower than the rest velocity
  std::vector<RowUse> use;    // kUsed where usable; of the motion's balance
  // Time from the nearest row in which no tooth surely carries, s; empty: a rigid gear or no
  // encoder on the motor.
  std::vector<double> from_contact_s;
  bool held = false;              // rows are holds: no motion between them, nothing to filter
  Eigen::MatrixXd rigid_columns;  // Run::rigid_columns; may be empty
  // Windows within which only changes count (gas.h, kinematic.h), numbered over all segments; -1:
  // in none. Empty: there are no windows.
  std::vector<int> window;
  Eigen::Index size() const { return static_cast<Eigen::Index>(samples.size()); }
};

struct StateSet {
  std::vector<StateSegment> segments;
  std::vector<std::string> run_names;
  std::set<std::string> measured;            // fields of JointSample that the recordings provide
  double rate_Hz = 0.0;                      // of the first run
  Eigen::VectorXd rigid_mean, rigid_spread;  // of segments' rigid_columns (Run)
  bool locked = false;      // in a recording the motor stood while the output was moved
  bool silent_load = true;  // no load cell, or it measured nothing but its noise: its mean stands
};

// Runs may differ in rate and length; options must be resolved.
StateSet MakeStates(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                    const ProcessingOptions& options);

}  // namespace sinew::identify
