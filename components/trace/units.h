// What is left out together in cross-validation: a window where the rows have any, a run, else a
// motion cycle, else a block of at least five correlation times of the residual (design.md, step
// 7). Runs and cycles only where there are nine or more: fewer cannot be told from their placebo.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/identify/block_regression.h"
#include "components/identify/design.h"

namespace sinew::trace {

struct Units {
  std::vector<identify::Block> blocks;
  std::string kind;  // "window", "run", "cycle", "block"
  double length_s = 0.0;
  double gap_s = 0.0;
};

// correlation_time_s: of the residual. fewest_rows: of a unit.
Units ChooseUnits(const identify::Design& design, double correlation_time_s, int fewest_rows);

// Period of the motion by the autocorrelation of position, where it exceeds 0.9; 0 when there is
// none.
double MotionPeriod(const identify::Design& design);

}  // namespace sinew::trace
