// The models of a comparison: which are compared, hyper-parameters drawn for the fair table, and
// one timed training.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reproduction/network_tables/comparison.h"
#include "reproduction/networks/dataset/dataset.h"
#include "reproduction/networks/model.h"
#include "reproduction/networks/samples.h"

namespace sinew::reproduction {

// Those of table 6.2 (sea), 6.4 (pea); force: those of 6.2 without published errors, and a linear
// one.
std::vector<networks::PublishedModel> ModelsOf(networks::Task task);

// Trial 0 is the published setting (in batches), the others are drawn. Deterministic for a seed.
networks::PublishedModel DrawHyperParameters(networks::PublishedModel plan, int trial,
                                             std::uint64_t seed, const ComparisonOptions& options);

// The hyper-parameters of a plan, for people.
std::string HyperText(const networks::PublishedModel& plan);

struct TimedFit {
  networks::FitResult fit;
  double seconds = 0.0;
};
TimedFit FitTimed(const networks::PublishedModel& plan, const networks::Samples& samples,
                  networks::Task task, std::uint64_t seed);

}  // namespace sinew::reproduction
