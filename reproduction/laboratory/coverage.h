// How often an experiment's 95 % intervals hold the truth, and how often its targets are met, over
// many specimens of the rig.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "components/model/experiment/result.h"

namespace sinew::laboratory {

struct Coverage {
  int seeds = 0;
  int covered = 0;  // intervals that held the truth
  int met = 0;      // targets met
  bool has_target = false;
  double largest_error = 0.0;    // |value - truth| over truth
  double mean_error = 0.0;       // (value - truth) over truth: the bias
  double mean_half_width = 0.0;  // over truth
  double share() const { return seeds > 0 ? static_cast<double>(covered) / seeds : 0.0; }
};

// By quantity id, of those with truth and interval. Not thread-safe.
class CoverageCount {
 public:
  void Add(const experiment::Result& result);
  const std::map<std::string, Coverage>& by_id() const { return by_id_; }

 private:
  std::map<std::string, Coverage> by_id_;
};

}  // namespace sinew::laboratory
