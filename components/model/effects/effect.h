// A physical effect: one definition that fitting, simulation and compensation share.
//
// An effect contributes a torque on the output, positive in the direction of +position:
//
//     tau(x) = sum_i theta_i * phi_i(x; psi, z)
//
// theta: linear parameters (fitted by least squares), psi: nonlinear parameters (profiled over a
// grid or refined), z: memory (hysteresis), advanced sample by sample. The balance of a joint is
//
//     sum over all effects of tau(x) = 0        (drive and inertia are effects too)
//
// so friction is negative for positive velocity, inertia is -J * acceleration, the drive is +.
//
// The other balances read the same way, each in its own unit; what takes the drive's place there is
// the measured side (docs/model.md): motor angle / N - output angle (rad) in the kinematic balance,
// the pressure (bar) in the gas balance.
// Thread: an Effect is immutable after construction; memory belongs to the caller.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/base/types/joint_kind.h"
#include "components/model/effects/sample.h"

namespace sinew::effects {

// Role of a term in the equation of motion.
enum class Role {
  kDrive,    // turns the drive input into torque
  kInertia,  // proportional to an acceleration
  kPassive,  // everything else
};

// The balances of the actuator (docs/model.md). Effects of the torque equation are kMotion.
enum class Balance { kMotion, kLink, kPlay, kGas, kKinematic };

// As in model files: "motion", "link", "play", "gas", "kinematic".
std::string_view BalanceName(Balance balance);
// Unit of a balance's sum, e.g. "Nm", "N" of a linear joint, "rad".
std::string_view BalanceUnit(Balance balance, types::JointKind kind);

// Physical dimension of a parameter; with the joint's kind it gives the unit suffix of the YAML
// key.
enum class Dimension {
  kNone,
  kTorque,
  kViscous,
  kQuadraticViscous,
  kInertia,
  kAngle,
  kVelocity,
  kFrequency,
  kTime,
  kMass,
  kTorquePerBar,
  kStiffness,
  kStiffnessPerBar,
  kTorquePerKelvin,
  kTorquePerAmpere,
  kTorquePerVolt,
  kInertiaTime,
  kPressure,
  kTemperature,
  kLength,
  kPerTorque,
  kCurrent,
  kPerCurrentSquared,
  kViscousPerKelvin,
  kInertiaTimeSquared,
  kAnglePerTorque,
  kRate,
};

// Suffix of a YAML key, e.g. {kViscous, kRevolute} -> "Nm_s_rad", {kViscous, kPrismatic} ->
// "N_s_m"; empty for kNone.
std::string_view UnitSuffix(Dimension dimension, types::JointKind kind);

struct ParameterInfo {
  std::string name;  // without unit, e.g. "viscous"
  Dimension dimension = Dimension::kNone;
  double lower = 0.0;  // physical range
  double upper = 0.0;
  double default_value = 0.0;
  std::vector<double> grid{};  // nonlinear parameters only: values tried when it is profiled
  std::string meaning{};
  // Scales the ideal drive torque (N Kt I, or force constant x u): the physical value is this one
  // divided by the drive's own factor (efficiency), see actuator::PhysicalValue.
  bool relative_to_drive = false;
  bool optional = false;  // model files may leave it out: default_value
};

// The parameter's key in files: name and unit suffix, e.g. "viscous_Nm_s_rad".
std::string ParameterKey(const ParameterInfo& info, types::JointKind kind);

// The body that a torque acts on. Outside the free play both move as one; a simulation keeps them
// apart.
enum class Side { kMotor, kOutput };

// An idealisation that every set-up breaks a little: a skew between channels of less than about a
// tenth of a sample, a valve whose opening takes some samples (its command is
// known to a row), teeth that give less than the encoder rounds. So small it is no effect, and
// nothing else is one that explains no more than it. And friction that builds up over less than a
// few counts of the encoder, from which no direction can be read: every contact yields a little
// before it slides. Torque that follows the snap is what a low-pass of the angles takes from an
// acceleration, too.
enum class Smallest { kAny, kTenthOfSample, kOpening, kRounding, kCounts, kBandwidth };

struct EffectInfo {
  std::string name;     // as in model files, e.g. "direction_dependent_viscous"
  std::string title;    // for people
  std::string formula;  // plain text or TeX-free unicode
  std::string source;   // paper or handbook, equation
  Role role = Role::kPassive;
  Balance balance = Balance::kMotion;
  Side side = Side::kOutput;
  Smallest smallest = Smallest::kAny;
  bool rate = false;  // phi is a rate of what the balance is about: fitting integrates it
  // Follows the drive input as recorded, over a span that is its first nonlinear parameter.
  bool follows_record = false;
  // Repeats as often in a turn of this shaft as its first nonlinear parameter says: at speed it is
  // faster than the low-pass of the angles (identify::Design::Columns).
  std::optional<Side> ripple = std::nullopt;
  bool rotary_only = false;  // reads an angle as an angle: means nothing on a linear joint
  // Misreads the pressure: the model has to declare what the pressure does (TorquePerBar).
  bool needs_pneumatics = false;
  // Begins at an instant that differs from recording to recording: the first nonlinear parameter is
  // its start, on the clock time_s.
  bool event = false;
  std::vector<ParameterInfo> linear;
  std::vector<ParameterInfo> nonlinear;
  std::string signature;  // what its residual looks like
  std::string variable;   // the signal its residual follows; left empty: the first that it needs
  std::vector<std::string> confounders;  // names of effects it is easily mistaken for
  std::string separating_excitation;     // distinguishes it from them
  std::vector<std::string> needs;        // signals it reads, field names of JointSample
  std::vector<std::string> may_read;     // more of them: 0 where they are not recorded
  std::vector<std::string> hardware;     // signals that show that the machine can have it at all
};

class Effect {
 public:
  explicit Effect(EffectInfo info) : info_(std::move(info)) {
    if (info_.variable.empty() && !info_.needs.empty()) info_.variable = info_.needs.front();
  }
  virtual ~Effect() = default;
  const EffectInfo& info() const { return info_; }

  // phi (size info().linear.size()) at x; psi has info().nonlinear.size() entries, memory
  // memory_size(). noexcept, allocates nothing. Non-finite input gives non-finite output, never
  // undefined behaviour.
  virtual void Regressors(const JointSample& x, std::span<const double> psi,
                          std::span<const double> memory, std::span<double> phi) const noexcept = 0;

  virtual int memory_size() const noexcept { return 0; }
  virtual void ResetMemory(const JointSample& /*x*/, std::span<const double> /*psi*/,
                           std::span<double> /*memory*/) const noexcept {}
  // Advances the memory from the sample before to x, dt_s later.
  virtual void Advance(const JointSample& /*x*/, double /*dt_s*/, std::span<const double> /*psi*/,
                       std::span<double> /*memory*/) const noexcept {}

 private:
  EffectInfo info_;
};

// An effect may have a form in more than one balance (a compliant gear shows in the torque at high
// frequency and in the difference of the encoders). Without a balance: the first form.
// Throws std::invalid_argument naming the effect and the known ones when there is no such effect,
// or the balances that it has.
std::unique_ptr<Effect> MakeEffect(std::string_view name, const JointConstants& constants,
                                   std::optional<Balance> balance = std::nullopt);

// No effect has more linear parameters, nonlinear parameters or memory than this: callers may keep
// them in arrays on the stack.
inline constexpr int kMaxParameters = 8;

// Every effect of the catalogue, in the order of the documentation: the declared basics first.
std::vector<std::string> EffectNames();

struct EffectForm {
  std::string name;
  Balance balance = Balance::kMotion;
};
// The same with every form of each, those of the torque balance first.
std::vector<EffectForm> EffectForms();

}  // namespace sinew::effects
