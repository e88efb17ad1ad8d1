// Size of a machine by what it does, and how large an effect on it may be expected: standard
// deviations of a prior that a machine of any size would get. Pure.
#pragma once

#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/trace/used_rows.h"

namespace sinew::trace {

// Units of the joint's output (N and m on a linear joint). As declared; where nothing is, a tenth
// of the drive's rms for the friction, as much at the highest speed for viscous friction, and the
// drive's rms for gravity.
struct MachineSize {
  double friction = 0.0;  // that only knows the direction
  double inertia = 0.0;   // both sides of the gear
  double viscous = 0.0;
  double gravity = 0.0;
  double drive_gain = 1.0;    // torque of one unit of the drive
  double drive_rms = 0.0;     // torque
  double drive_peak = 0.0;    // torque
  double quick = 0.0;         // highest speed
  double pressure_bar = 0.0;  // highest; 0: not recorded
};

// used: the rows that count.
MachineSize SizeOf(const identify::Design& design, const UsedRows& used,
                   const actuator::JointModel& model);

// Standard deviation of a parameter about zero, in its own unit; infinite: anything may be
// expected.
double ExpectedSize(const effects::ParameterInfo& parameter, const MachineSize& machine,
                    const effects::JointConstants& constants);

}  // namespace sinew::trace
