// Processing of a recording, and the settings that follow from its motion: cut-offs, rest and
// guards from spectra and quantiles of the signals, none in a unit of its own. Pure; allocates;
// throws std::invalid_argument for recordings and models that cannot be used.
#pragma once

#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"

namespace sinew::identify {

// A signal of which more than this share is noise, white and by fourth differences, says nothing.
inline constexpr double kMostNoise = 0.3;

struct ProcessingOptions {
  double state_cutoff_Hz = 0.0;  // low-pass of position and pressure; 0: from the data
  double motor_cutoff_Hz = 0.0;  // the same of the motor's angle; 0: as state_cutoff_Hz
  int state_order = 4;
  double parallel_cutoff_Hz = 0.0;  // low-pass of both sides of the balance; 0: from the data
  int parallel_order = 4;
  double rest_velocity = 0.0;      // rad/s or m/s; slower is rest or reversal; 0: from the data
  double reversal_guard_s = 0.05;  // left out on either side of rest and reversals
  double settle_distance = 0.0;  // rad or m; left out after rest and reversals until it is covered
  // Left out on either side of rows in which no tooth surely carries; 0: what a touch excites is
  // left out like a reversal, and nothing else.
  double contact_guard_s = 0.0;
  double border_s = 0.5;        // left out at both ends of a piece
  double longest_gap_s = 0.25;  // longer gaps cut a recording into pieces
  // Rows at the recording's own rate (FromMotion): the motor's angle stays as it was measured, the
  // load cell goes through the low-pass of the output's angle.
  bool raw = false;
  // A velocity below the first of these is taken from a low-pass at the second: slow ramps would
  // drown in the noise of a quick derivative. 0: it is not.
  double doubtful_velocity = 0.0;  // rad/s or m/s
  double slow_cutoff_Hz = 0.0;
};

// The signal that a joint's drive term reads; throws std::invalid_argument when the model has no
// drive term or more than one.
types::Signal DriveSignal(const actuator::JointModel& model);

// Fills in what the options leave to the data: state cut-off where the position's spectrum sinks to
// four times its level near the Nyquist frequency (between 1/50 and 1/4 of the rate), parallel
// cut-off at a quarter of that, rest velocity at 3 % of the velocity's rms.
ProcessingOptions Resolve(const ProcessingOptions& options, const std::vector<types::Run>& runs);

// Settings from the motion alone: the low-pass of each angle where its spectrum meets its noise,
// and no wider than the noise of its acceleration allows beside that of the drive; a softer one,
// with shorter guards, where the motor has an encoder of its own. Rest from quantiles of the speed,
// guards from the filters. No second filter; but where the drive was
// low-passed before it was recorded, no row is as it was measured, and both sides of the balance go
// through a common filter below that one (Resolve). wider: factor on the angles' cut-offs;
// least_Hz: of the output's low-pass, before that factor.
ProcessingOptions FromMotion(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                             double longest_gap_s, double wider = 1.0, double least_Hz = 0.0);

// Up to which cut-off of the output's angle the noise of its acceleration stays unseen beside that
// of the drive, Hz; 0: the drive has none.
double QuietBand(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                 double longest_gap_s);

// Torque per unit of the drive signal, as declared; sum of the declared inertias of one side.
double NominalDriveGain(const actuator::JointModel& model);
double NominalInertia(const actuator::JointModel& model, effects::Side side);

// The balances beside the motion's (kinematic.h, gas.h): neither states nor rows are filtered a
// second time, no velocity is too fast. `motion` must be resolved; rate_Hz of the recordings.
ProcessingOptions Unfiltered(const ProcessingOptions& motion, double rate_Hz);

}  // namespace sinew::identify
