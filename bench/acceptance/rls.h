// Recursive least squares: equal to batch least squares where it should be, bounded for ever
// without excitation, and how long an update takes.
//
// 76 features and 12 outputs are the biped's network. Deterministic for a seed but for the times.
#pragma once

#include <cstdint>
#include <vector>

namespace sinew::acceptance {

// Required: equal but for rounding, relative.
inline constexpr double kSameAsBatch = 1e-9;
// Required: the largest eigenvalue of P stays below this many priors.
inline constexpr double kMostGrowth = 2.0;
// Required on an idle core: an update of 76 x 12.
inline constexpr double kUpdate_us = 1.8;

struct BatchScore {
  long updates = 0;
  double readout_difference = 0.0;     // of the norms, relative to the batch solution
  double covariance_difference = 0.0;  // the same
};
// 76 x 12, without forgetting, leak and clipping.
BatchScore CompareWithBatch(long updates, std::uint64_t seed);

struct SoakScore {
  long updates = 0;
  long at_rest = 0;                 // of these, with features that do not change
  double settled_Nm = 0.0;          // rms error in the second half of each stretch
  double noise_Nm = 0.0;            // of a sample
  double largest_eigenvalue = 0.0;  // of P, by the prior's: 1 is the prior
  double smallest_eigenvalue = 0.0;
  bool finite = true;
  bool bounded() const;
  // The plain recursion on the same samples: updates until P is no longer positive definite or has
  // grown beyond 1e6 priors; 0: it stayed in bounds as long as it ran.
  long plain_lost_after = 0;
};
// 77 features in motion for 4000 samples, then at rest for 10 000, again and again.
SoakScore Soak(long updates, std::uint64_t seed);

struct TimeScore {
  int features = 0, outputs = 0;
  double update_us = 0.0;  // the least of many batches: an idle core
  double median_us = 0.0;
  double textbook_us = 0.0;  // the plain recursion with a full covariance, least of many batches
};
TimeScore TimeUpdates(int features, int outputs);

}  // namespace sinew::acceptance
