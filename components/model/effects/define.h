// For the files of catalogue/ only: how an effect is written down in one place.
//
// A file catalogue/NAME.cc defines `Make` in namespace sinew::effects::NAME: it completes a
// description that has its name and balance already. The list in CMakeLists.txt is the registry;
// nothing else has to be registered.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <type_traits>
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

// Physical range of a parameter.
struct Between {
  double lower, upper;
};

inline ParameterInfo Linear(const char* name, Dimension dimension, Between range,
                            const char* meaning, double default_value = 0.0) {
  return {name, dimension, range.lower, range.upper, default_value, {}, meaning};
}

inline ParameterInfo Nonlinear(const char* name, Dimension dimension, Between range,
                               double default_value, std::vector<double> grid,
                               const char* meaning) {
  return {name, dimension, range.lower, range.upper, default_value, std::move(grid), meaning};
}

inline ParameterInfo RelativeToDrive(ParameterInfo parameter) {
  parameter.relative_to_drive = true;
  return parameter;
}

// phi of an effect without memory.
using RegressorFunction = void (*)(const JointSample& x, const JointConstants& constants,
                                   std::span<const double> psi, std::span<double> phi);

std::unique_ptr<Effect> MakeMemoryless(const JointConstants& constants, EffectInfo info,
                                       RegressorFunction regressors);

// An effect without memory from its description and its regressors: a lambda without captures that
// is a RegressorFunction, or that returns the only phi and takes no more of x, constants and psi
// than it needs.
template <class Function>
std::unique_ptr<Effect> Memoryless(const JointConstants& constants, EffectInfo info, Function) {
  return MakeMemoryless(
      constants, std::move(info),
      [](const JointSample& x, const JointConstants& c, std::span<const double> psi,
         std::span<double> phi) {
        constexpr Function kPhi{};
        if constexpr (std::is_invocable_v<Function, decltype(x)>) {
          phi[0] = kPhi(x);
        } else if constexpr (std::is_invocable_v<Function, decltype(x), decltype(c)>) {
          phi[0] = kPhi(x, c);
        } else if constexpr (std::is_invocable_v<Function, decltype(x), decltype(c),
                                                 decltype(psi)>) {
          phi[0] = kPhi(x, c, psi);
        } else {
          kPhi(x, c, psi, phi);
        }
      });
}

}  // namespace sinew::effects
