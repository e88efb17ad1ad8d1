// For the files of catalogue/ only: how an effect is written down in one place.
//
// A file catalogue/NAME.cc defines `std::unique_ptr<Effect> Make(const JointConstants&)` in
// namespace sinew::effects::NAME. The list in CMakeLists.txt is the registry; nothing else has
// to be registered.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "components/model/effects/effect.h"

namespace sinew::effects {

// -1, 0 or 1; NaN for a value that is not finite, so that bad input is never hidden by a sign.
inline double Sign(double value) noexcept {
  return static_cast<double>(value > 0.0) - static_cast<double>(value < 0.0) + 0.0 * value;
}

// Torque of an ideal drive that is left for the load behind gear and friction, Nm at the output.
// What the rotor takes stays in it: a simulation knows no acceleration before the friction.
inline double LoadTorque(const JointSample& x, const JointConstants& c) noexcept {
  return IdealDriveGain(c) * x.drive_input - c.drive_coulomb_Nm * Sign(x.velocity_rad_s) -
         c.drive_viscous_Nm_s_rad * x.velocity_rad_s;
}

// phi of an effect without memory.
using RegressorFunction = void (*)(const JointSample& x, const JointConstants& constants,
                                   std::span<const double> psi, std::span<double> phi);

// An effect without memory from its description and its regressors.
std::unique_ptr<Effect> Memoryless(const JointConstants& constants, EffectInfo info,
                                   RegressorFunction regressors);

}  // namespace sinew::effects
