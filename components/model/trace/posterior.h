// Probabilities of the names that may stand in the place of an effect of the selected set.
//
// The best set and those in which one member is replaced by another effect, each at its best
// setting, are compared; all names are equally probable beforehand. No shape of the catalogue is
// exact: the shape of the true effect loses a share s of the member's net gain against the best
// one, exponentially distributed with the mean of rule shape_misfit (maximum entropy). The
// probability of a name is then proportional to exp(-s / mean); where the gain is so small that
// noise decides, to exp(-loss / 2), the ratio of likelihoods. Every parameter counts as another
// hundredth of the gain lost: as much as one more takes of what an approximate shape leaves. Pure;
// allocates.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "components/model/trace/rules.h"

namespace sinew::trace {

struct NameProbability {
  std::string name;
  double probability = 0.0;
};

using Posterior = std::vector<NameProbability>;

struct Alternative {
  double loss = 0.0;  // net gain that it costs in the member's place
  std::size_t parameters = 1;
};

// gain: the member's net gain beside the others; possible: every name in its place, itself with a
// loss of 0. Most probable first; those below a hundredth are left out.
Posterior PosteriorOfNames(double gain, const std::map<std::string, Alternative>& possible,
                           const InForce& in_force);

// The number of them that are named: from the first on as many as hold 90 %, at most three.
std::size_t NamedCount(const Posterior& posterior);

// The names of them behind the first.
std::vector<std::string> RivalsOf(const Posterior& posterior);

// Mean of several, a name that one does not hold counts as 0 there; `first` comes first.
Posterior MeanPosterior(const std::string& first, const std::vector<Posterior>& all);

}  // namespace sinew::trace
