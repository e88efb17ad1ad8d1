// Size of a machine by what it does, and how large an effect on it may be expected: standard
// deviations of a prior that a machine of any size would get. Pure.
#pragma once

#include <limits>
#include <span>

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

// The catalogue's range of a parameter, applied to any machine: of a ratio all of it; of what has
// a unit the sign, since how large it may be is the machine's affair.
struct Range {
  double lower = 0.0, upper = 0.0;
};

inline Range RangeOnAnyMachine(const effects::ParameterInfo& info) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (info.dimension == effects::Dimension::kNone) return {info.lower, info.upper};
  return {info.lower >= 0.0 ? 0.0 : -kAny, info.upper <= 0.0 ? 0.0 : kAny};
}

// Range of parameter `linear` of an effect that is added to a model, in its unit. Where it has one
// and a declared term the same column (compliance of the teeth in free_play and gear_compliance),
// the two add up to one quantity: their sum is held to its range, the addition alone to none.
Range RangeOfAddition(const identify::Design& design, const actuator::JointModel& model,
                      const effects::Effect& effect, std::span<const double> psi,
                      std::size_t linear);

}  // namespace sinew::trace
