// What a rig does and its declared model lacks: effects of the catalogue by their names
// there, effects outside of it, and structured ignorance. Their formulas are this folder's own.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bench/rigs/drawn/rig.h"

namespace sinew::rigs {

enum class Kind { kCatalogue, kOutside, kIgnorance };
// The balance of the declared model in which an effect shows: torque (M), encoders (K), gas (Q), or
// torque with the motor locked (S).
enum class Shows { kTorque, kKinematic, kGas, kLocked };

struct Effect {
  std::string name;
  double size = 0.0;              // in the effect's unit
  std::array<double, 4> shape{};  // drawn with the rig
};

struct EffectInfo {
  std::string name;
  Kind kind = Kind::kCatalogue;
  Shows shows = Shows::kTorque;
  std::string unit;      // of size; "force" is Nm or N
  std::string variable;  // what the residual follows
  bool absorbed =
      false;  // by a refit of declared parameters: sized by the likelihood, not by share
};

// Every effect, in a fixed order.
const std::vector<EffectInfo>& AllEffects();
// Throws std::invalid_argument for a name that is not there.
const EffectInfo& FindEffect(const std::string& name);

// Those that the rig's hardware can have and the recordings of the excitation can be made with.
std::vector<std::string> EffectsOf(const Rig& rig, Kind kind);

// The effect with a drawn shape and a size of 1 % of what is plausible at most; LargestSize is
// that.
Effect DrawEffect(const Rig& rig, const std::string& name);
double LargestSize(const Rig& rig, const std::string& name);

}  // namespace sinew::rigs
