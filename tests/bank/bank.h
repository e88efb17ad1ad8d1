// The test bank: does the tracer name what was hidden in the surrogate, and is it silent where
// nothing was? One process, no topics, no files; the same path as `sinew close-loop`
// (trace::CloseLoop). Deterministic by seed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/bank/sizes.h"

namespace sinew::bank {

enum class Kind {
  kEffect,   // one effect of the catalogue
  kNone,     // nothing undeclared
  kPair,     // two effects of the catalogue
  kOutside,  // one that the catalogue does not know
};

struct Case {
  Kind kind = Kind::kEffect;
  std::vector<std::string> effects;
  Strength strength = Strength::kStrong;
  surrogate::ExcitationKind excitation = surrogate::ExcitationKind::kDesigned;
  std::uint64_t seed = 1;
  bool coloured = false;  // noise with memory on the current
};

struct Found {
  std::string name;
  std::vector<std::string> rivals;
  bool swallowed = false;
};

struct Outcome {
  Case what;
  std::string verdict;  // effect, none, unexplained
  std::vector<Found> found;
  std::string variable;  // of what stays unexplained
  std::vector<std::string> not_excited;
  std::vector<std::string> shift_causes;  // effects that point the way of a declared parameter
  // Sealed error, N·m: declared model refitted, as corrected, of the oracle; 0: has none.
  double sealed_before = 0.0, sealed_after = 0.0, sealed_oracle = 0.0;
  bool oracle_significant = false;
  // Parameter of the effect where it was named first: found, of the true structure on the same
  // recordings without noise, and the half width told. NaN: none.
  double value = 0.0, truth = 0.0, half_width = 0.0;
  std::string explanation;  // the first candidates of every round, a line each
  double seconds = 0.0;
};

struct Plan {
  int seeds = 8;
  std::uint64_t first_seed = 1;
  std::vector<std::string> effects;  // empty: all
  int without = 500;                 // recordings without an effect
  int pair_seeds = 2;                // of each of the 20 pairs
  bool task = true;                  // beside the designed excitation
  bool parameters = true;            // compare parameters with recordings without noise
};
std::vector<Case> MakeCases(const Plan& plan);

// E.g. "stribeck/strong/designed, seed 3".
std::string CaseName(const Case& what);

// Recorded, traced, judged. May be called from several threads.
Outcome RunCase(const Case& what, bool parameters);

// Runs them on `threads` threads; `done` is called after each, one at a time, in any order.
std::vector<Outcome> RunCases(const std::vector<Case>& cases, int threads, bool parameters,
                              const std::function<void(const Outcome&)>& done = {});

// Names of the effects of the surrogate that the catalogue should know.
std::vector<std::string> CatalogueNames();
std::vector<std::string> OutsideNames();

}  // namespace sinew::bank
