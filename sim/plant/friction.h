// Dry friction and stops as impulses: bodies that should stick stand exactly still.
//
// With W the inverse inertia and v_free the velocity without friction after the step dt, the
// impulses p solve
//
//     v = v_free + W p,   lower <= p <= upper,   v_i > 0 => p_i = lower_i,   v_i < 0 => p_i =
//     upper_i
//
// (friction: lower = -dt F, upper = dt F; a stop that blocks +: lower = -infinity), by projected
// Gauss-Seidel: exact after one round for one joint. Source: Moreau's time stepping, e.g. Acary,
// Brogliato: Numerical Methods for Nonsmooth Dynamical Systems (2008), ch. 10.
#pragma once

#include <span>

namespace sinew::plant {

// velocity: in v_free, out v. inverse_inertia: row-major n x n, symmetric, positive diagonal.
// impulse: n, out. A joint that sticks gets the velocity 0 exactly. Allocates nothing.
void ApplyImpulses(std::span<const double> inverse_inertia, std::span<const double> lower,
                   std::span<const double> upper, std::span<double> impulse,
                   std::span<double> velocity) noexcept;

// The same from an estimate of the impulses, such as those of the step before: fewer rounds for
// many joints.
void ApplyImpulsesFrom(std::span<const double> inverse_inertia, std::span<const double> lower,
                       std::span<const double> upper, std::span<double> impulse,
                       std::span<double> velocity) noexcept;

}  // namespace sinew::plant
