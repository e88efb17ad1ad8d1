// The fields that are an object's state, once for both ways (types/state_archive.h).
#include <stdexcept>

#include "components/base/types/state_archive.h"
#include "components/learn/rls/adapter.h"

namespace sinew::rls {

// Gain, errors and the like are made anew in every update.
void RecursiveLeastSquares::Exchange(types::StateArchive& archive) {
  archive(innovation_variance_, updates_, clipped_, u_, d_, weight_, innovation_);
  archive.Bounded(coordinate_, size_ - 1);
}

void Adapter::Slot::Exchange(types::StateArchive& archive) { archive(estimator, version); }

void Adapter::Exchange(types::StateArchive& archive) {
  archive(slots_, updates_, still_s_);
  archive.Bounded(network_, 1);
  if (!has(network_)) throw std::invalid_argument("state: it learns a network that is not here");
}

}  // namespace sinew::rls
