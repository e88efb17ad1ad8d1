#include "components/model/trace/posterior.h"

#include <algorithm>
#include <cmath>

namespace sinew::trace {

namespace {

constexpr double kNamedMass = 0.9;
constexpr std::size_t kMostNames = 3;
constexpr double kLeastProbability = 0.01;

// Loss by one parameter, share of the gain.
constexpr double kParameter = 0.01;

// Normalised, most probable first; of those below a hundredth only `kept` stays.
Posterior Sorted(const std::map<std::string, double>& weights, const std::string& kept) {
  double sum = 0.0;
  for (const auto& [name, weight] : weights) sum += weight;
  Posterior out;
  for (const auto& [name, weight] : weights) out.push_back({name, sum > 0.0 ? weight / sum : 1.0});
  std::stable_sort(out.begin(), out.end(), [](const NameProbability& a, const NameProbability& b) {
    return a.probability > b.probability;
  });
  std::erase_if(out, [&](const NameProbability& entry) {
    return entry.name != kept && entry.probability < kLeastProbability;
  });
  return out;
}

}  // namespace

Posterior PosteriorOfNames(double gain, const std::map<std::string, Alternative>& possible,
                           const InForce& in_force) {
  const double scale = std::max(2.0, in_force.Limit(rules::kShapeMisfit) * gain);
  std::map<std::string, double> weights;
  for (const auto& [name, alternative] : possible) {
    // Beside other shapes than those that the set was chosen with, one may gain a little more.
    const double parameters = static_cast<double>(alternative.parameters);
    const double loss = std::max(0.0, alternative.loss) + kParameter * gain * parameters;
    weights[name] = std::exp(-loss / scale);
  }
  return Sorted(weights, "");
}

std::size_t NamedCount(const Posterior& posterior) {
  double mass = 0.0;
  std::size_t count = 0;
  while (count < std::min(kMostNames, posterior.size()) && mass < kNamedMass) {
    mass += posterior[count++].probability;
  }
  return count;
}

std::vector<std::string> RivalsOf(const Posterior& posterior) {
  std::vector<std::string> out;
  for (std::size_t k = 1; k < NamedCount(posterior); ++k) out.push_back(posterior[k].name);
  return out;
}

Posterior MeanPosterior(const std::string& first, const std::vector<Posterior>& all) {
  std::map<std::string, double> weights = {{first, all.empty() ? 1.0 : 0.0}};
  for (const Posterior& one : all) {
    for (const NameProbability& entry : one) weights[entry.name] += entry.probability;
  }
  Posterior out = Sorted(weights, first);
  std::stable_partition(out.begin(), out.end(),
                        [&](const NameProbability& entry) { return entry.name == first; });
  return out;
}

}  // namespace sinew::trace
