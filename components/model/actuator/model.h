// The grey-box model of a joint: a list of effects with their parameters, as in the model file.
// The same object is fitted (identify), simulated (sim/plant) and compensated (control).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/model/effects/effect.h"

namespace sinew::actuator {

// A declared value with what is known of it beforehand: a Gaussian prior about the value, whose one
// standard deviation is the tolerance, stated relative to the value or absolute (never both).
struct ParameterValue {
  double value = 0.0;
  double tolerance = 0.0;               // relative, of the declared nominal value; 0: not stated
  double tolerance_absolute = 0.0;      // in the parameter's unit; 0: not stated
  bool fixed = false;                   // known exactly: never refitted
  std::optional<double> half_width_95;  // of the last fit
};

// Standard deviation of the prior, in the parameter's unit; 0: flat, nothing is known. Of a
// declared value: a relative tolerance of a fitted one is another width, and of 0 it says nothing.
// A fixed parameter has no prior, ask for `fixed` first.
double PriorSpread(const ParameterValue& declared);
// The same as a share of the value; 0: flat, or a value of 0.
double RelativeSpread(const ParameterValue& declared);

struct Term {
  std::shared_ptr<const effects::Effect> effect;
  std::vector<ParameterValue> linear;     // as effect->info().linear
  std::vector<ParameterValue> nonlinear;  // as effect->info().nonlinear
  bool declared = true;                   // false: added by close-loop
};

// Values of a term's nonlinear parameters: psi of its effect.
std::vector<double> NonlinearValues(const Term& term);

// A term with every parameter at the catalogue's default. Throws std::invalid_argument
// (MakeEffect).
Term MakeTerm(std::string_view effect_name, const effects::JointConstants& constants,
              std::optional<effects::Balance> balance = std::nullopt);

// The servo that moved the joint while it was recorded; identify and simulation need it only to
// repeat the motion (free_run).
//
//     command = clamp(gain (reference - q) - velocity_gain v, -limit, limit)
//
// and the drive signal is the command, or the command times the supply voltage.
struct Servo {
  double gain_per_rad = 0.0;  // 0: differs from recording to recording and is read from each
  double velocity_gain_s_rad = 0.0;
  double limit = 0.0;            // of the command; 0: none
  bool share_of_supply = false;  // command is a duty: times supply_voltage
};

struct HistoryEntry {
  std::string when;       // ISO 8601, UTC
  std::string effect;     // what was added
  std::string recording;  // from which data
  std::string note;
};

class JointModel {
 public:
  std::string name;
  types::JointKind kind = types::JointKind::kRevolute;
  effects::JointConstants constants;
  double backlash_rad = 0.0;           // full width of the play at the output; 0: none
  double motor_torque_limit_Nm = 0.0;  // at the motor shaft; 0: none
  std::vector<Term> terms;             // of every balance
  std::vector<HistoryEntry> history;
  std::optional<Servo> controller;
  // The balance that fitting and tracing are about, and whose terms the sums below are of. Model
  // files hold all balances and give the motion's.
  effects::Balance balance = effects::Balance::kMotion;

  // Index of a term, or -1; of any balance unless one is given.
  int Find(std::string_view effect_name, std::optional<effects::Balance> of = std::nullopt) const;
  // Does the term belong to the balance that the model is about?
  bool Counts(const Term& term) const { return term.effect->info().balance == balance; }
  // Does the model declare a balance: a term that is its measured side?
  bool Declares(effects::Balance of) const;
  // Value of a linear or nonlinear parameter; throws std::invalid_argument when the model lacks it.
  double Parameter(std::string_view effect_name, std::string_view parameter) const;

  // Sizes of the memory that Evaluate needs (all terms together).
  int memory_size() const;
  void ResetMemory(const effects::JointSample& x, std::span<double> memory) const;
  void Advance(const effects::JointSample& x, double dt_s, std::span<double> memory) const noexcept;

  // Torque of one term at x (positive in +position).
  double TermTorque(int index, const effects::JointSample& x,
                    std::span<const double> memory) const noexcept;
  // Sum over the terms of a role.
  double Torque(effects::Role role, const effects::JointSample& x,
                std::span<const double> memory) const noexcept;
  // Sum over the terms that act on one body (any role): what a simulation with free play
  // integrates.
  double SideTorque(effects::Side side, const effects::JointSample& x,
                    std::span<const double> memory) const noexcept;
  // Drive input (A or V) at which the balance holds; x.drive_input is not read. 0 without a drive
  // term. Finite for finite x: where no input gives the torque (a drive that saturates), the one
  // that comes closest, and reached, if asked for, is false.
  double RequiredDriveInput(const effects::JointSample& x, std::span<const double> memory,
                            bool* reached = nullptr) const noexcept;
  // Drive torque at the output that x needs: -(inertia + passive terms), terms that follow the
  // drive included; x.drive_input is not read. Feed-forward uses this.
  double RequiredDriveTorque(const effects::JointSample& x,
                             std::span<const double> memory) const noexcept;
  // drive + inertia + passive: 0 where the model is right.
  double Residual(const effects::JointSample& x, std::span<const double> memory) const noexcept;
};

// Makes every effect anew: they know the model's constants from when they were made. Those of the
// pneumatic element and of friction are taken from its terms first.
void RemakeEffects(JointModel* model);

// The drive term's factor in a balance as a share of the ideal drive's; 1 without a drive term.
double DriveShare(const JointModel& model, effects::Balance balance);

// Value of a linear parameter in its own unit: one that is relative to the drive (ParameterInfo) is
// divided by the drive's share. Throws std::out_of_range.
double PhysicalValue(const JointModel& model, int term, int linear_parameter);
// The term with all its linear parameters and their half widths in their own units. Throws
// std::out_of_range.
Term PhysicalTerm(const JointModel& model, int term);

// A point mass that the robot carries and its URDF lacks (components/model/payloads/payloads.h).
struct Payload {
  std::string link;                     // of the URDF
  double mass_kg = 0.0;                 // above 0
  std::array<double, 3> position_m{};   // in the link's frame
  bool declared = true;                 // false: added by close-loop
  std::optional<double> half_width_95;  // of the mass, kg, of the fit that added it
  // Half widths, m. A coordinate whose half width exceeds the length of the link is assumed.
  std::optional<std::array<double, 3>> position_half_width_95;
};

// Sensors of the body of a robot that stands on two feet, and how well its links and its IMU are
// known: the base floats, and all joints share one balance (components/model/stance_fit).
struct FloatingBase {
  std::array<std::string, 8> force_links;  // in the order of the topic foot_force
  std::string imu_link;
  double mass_tolerance = 0.01;  // standard deviations: share of the mass of links that move as one
  double com_tolerance_m = 1e-3;     // of their centre of mass, per axis
  double tilt_tolerance_rad = 1e-3;  // of the IMU against the base, about x and y
};

struct RobotModel {
  std::string name;
  std::string urdf_path;  // relative to the model file; empty: none
  std::vector<JointModel> joints;
  std::vector<Payload> payloads = {};
  std::optional<FloatingBase> floating_base = std::nullopt;
};

}  // namespace sinew::actuator
