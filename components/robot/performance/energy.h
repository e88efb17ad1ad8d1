// Energies of a joint: integrals of its powers over the ticks.
//
// Joint side: tau the drive's torque, w the joint's velocity, both positive in the same direction,
// p = tau w > 0 where the drive does work on the link. Motor side: I the current, N the gear ratio.
//
//     absolute_J          int |p| dt         of tables that count braking as effort
//     positive_J          int max(p, 0) dt   positive mechanical work
//     net_J               int p dt           returned work subtracted
//     copper_loss_J       int R I^2 dt
//     electrical_net_J    int P dt           P = R I^2 + Kt I N w: the supply takes back, without
//                                            loss, what the motor regenerates (P < 0)
//     electrical_drawn_J  int max(P, 0) dt   regenerated energy is lost: a supply without a sink
//
// absolute = 2 positive - net; drawn >= net; copper loss >= 0. Kt I N w is the motor's own
// mechanical power, so the gearbox's loss is contained in the electrical energies but not in those
// of the joint side. R is the resistance for which R I^2 is the loss at the current I for which
// Kt I is the motor's torque: 3/2 of the phase resistance where I is the q current of an
// amplitude-invariant transform. Left out: the inverter's losses and idle power; the energy of the
// inductance, which is zero between equal currents. Trapezoidal rule, zero crossings exact; lost
// samples are bridged up to bridge_s and counted. Errors of both: README.md.
//
// A linear joint has N, m/s and N/A for N m, rad/s and N m/A. Time is ticks times the nominal
// period; a relative error of the period is one of the energy.
// Sources: thesis tables 6.6, 6.7 and 7.1 give energies without a formula, so each is named here.
// Threads: one. Step is noexcept and allocates nothing.
#pragma once

#include <cstdint>

#include "components/robot/performance/compensated_sum.h"

namespace sinew::performance {

inline constexpr double kBridge_s = 0.05;  // derived above

// Counts of the ticks since the first one: integrated + bridged + omitted + pending.
struct Coverage {
  std::uint64_t integrated = 0;  // both ends were measured
  std::uint64_t bridged = 0;     // in gaps that were bridged
  std::uint64_t omitted = 0;     // in gaps too long, or before the first sample
  std::uint64_t pending = 0;     // in a gap that has not ended; it adds nothing so far
};

// One power, integrated three ways.
class PowerIntegral {
 public:
  // Throws std::invalid_argument: a period that is not positive, a negative bridge_s.
  explicit PowerIntegral(double period_s, double bridge_s = kBridge_s);

  // A power that is not usable is lost. A tick that is not after the last one is left out.
  void Step(std::uint64_t tick, double power_W) noexcept;

  double absolute_J() const noexcept { return 2.0 * positive_.value() - net_.value(); }
  double positive_J() const noexcept { return positive_.value(); }
  double net_J() const noexcept { return net_.value(); }
  const Coverage& coverage() const noexcept { return coverage_; }

 private:
  double period_s_;
  std::uint64_t bridge_ticks_;
  CompensatedSum positive_, net_;
  Coverage coverage_;
  bool started_ = false, has_sample_ = false;
  std::uint64_t last_tick_ = 0;    // of Step
  std::uint64_t sample_tick_ = 0;  // of the last usable sample, or the first tick
  double sample_W_ = 0.0;
};

struct MotorConstants {
  double copper_resistance_Ohm = 0.0;  // R; 0: not known, and no electrical energy is reported
  double torque_constant_Nm_A = 0.0;   // Kt
  double gear_ratio = 1.0;             // N, motor turns per joint turn; negative: opposite turn
};

struct Energies {
  double absolute_J = 0.0;
  double positive_J = 0.0;
  double net_J = 0.0;
  bool electrical_known = false;  // R is known; the next three are 0 otherwise
  double copper_loss_J = 0.0;
  double electrical_net_J = 0.0;
  double electrical_drawn_J = 0.0;
};

class JointEnergy {
 public:
  // Throws std::invalid_argument as PowerIntegral; for constants that are negative (a gear ratio:
  // zero) or not finite; for a resistance without a torque constant.
  JointEnergy(const MotorConstants& motor, double period_s, double bridge_s = kBridge_s);

  // torque_Nm: of the drive, at the joint; current_A: of the motor. One that is not usable makes
  // lost what is computed from it, and nothing else.
  void Step(std::uint64_t tick, double torque_Nm, double velocity_rad_s, double current_A) noexcept;

  Energies energies() const noexcept;
  // Power of this tick's sample: R I^2 + Kt I N w; not a number where it is lost or R is not known.
  double electrical_W() const noexcept { return electrical_W_; }
  const Coverage& mechanical() const noexcept { return mechanical_.coverage(); }
  const Coverage& electrical() const noexcept { return electrical_.coverage(); }
  const Coverage& copper() const noexcept { return copper_.coverage(); }

 private:
  MotorConstants motor_;
  PowerIntegral mechanical_, copper_, electrical_;
  double electrical_W_;
};

}  // namespace sinew::performance
