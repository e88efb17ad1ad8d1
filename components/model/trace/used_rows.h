// The rows of a design that count, as stretches that follow each other in time, and the blocks of
// time that inference treats as independent. Rows that are holds follow no other: each is a stretch
// of its own, and blocks are groups of neighbours. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/model/identify/block_regression.h"
#include "components/model/identify/design.h"
#include "components/model/trace/noise_model.h"

namespace sinew::trace {

struct UsedRows {
  std::vector<Eigen::Index> rows;       // of the design
  std::vector<Stretch> stretches;       // in numbers of `rows`
  std::vector<identify::Block> blocks;  // in numbers of `rows`
  double block_s = 0.0;                 // length of a block in time

  Eigen::Index size() const { return static_cast<Eigen::Index>(rows.size()); }
  Eigen::MatrixXd Of(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
    return columns(rows, Eigen::all);
  }
};

// Blocks needed for a cluster-robust test: fewer leave its null distribution too coarse (Cameron,
// Miller 2015, section VI: few clusters); more would cut through cycles of the motion.
inline constexpr int kMostBlocks = 60;

// Blocks never cross a segment or a window; every one holds at least fewest_rows used rows.
UsedRows MakeUsedRows(const identify::Design& design, int fewest_rows);
// The same of any rows, in rising order.
UsedRows MakeUsedRows(const identify::Design& design, std::vector<Eigen::Index> rows,
                      int fewest_rows);

}  // namespace sinew::trace
