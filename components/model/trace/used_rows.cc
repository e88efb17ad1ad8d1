#include "components/model/trace/used_rows.h"

#include <algorithm>

namespace sinew::trace {

UsedRows MakeUsedRows(const identify::Design& design, std::vector<Eigen::Index> rows,
                      int fewest_rows) {
  UsedRows out;
  out.rows = std::move(rows);
  const identify::Rows& all = design.rows();
  const auto at = [&](Eigen::Index i) { return static_cast<std::size_t>(i); };
  const auto window = [&](Eigen::Index i) { return all.window.empty() ? 0 : all.window[at(i)]; };
  const Eigen::Index n = out.size();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index i = out.rows[at(k)];
    const bool follows = k > 0 && !design.held() && out.rows[at(k - 1)] == i - 1 &&
                         all.segment[at(i - 1)] == all.segment[at(i)] && window(i - 1) == window(i);
    if (!follows) out.stretches.push_back({k, 0});
    ++out.stretches.back().count;
  }
  const auto share = std::max<Eigen::Index>(
      fewest_rows, static_cast<Eigen::Index>((n + kMostBlocks - 1) / kMostBlocks));
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index i = out.rows[at(k)];
    const Eigen::Index before = k > 0 ? out.rows[at(k - 1)] : i;
    const bool cut = k > 0 && (all.segment[at(before)] != all.segment[at(i)] ||
                               (!all.window.empty() && window(before) != window(i)));
    const bool full =
        !out.blocks.empty() && static_cast<Eigen::Index>(out.blocks.back().size()) >= share;
    if (out.blocks.empty() || full ||
        (cut && static_cast<Eigen::Index>(out.blocks.back().size()) >= fewest_rows)) {
      out.blocks.emplace_back();
    }
    out.blocks.back().push_back(k);
  }
  if (out.blocks.size() > 1 && static_cast<int>(out.blocks.back().size()) < fewest_rows) {
    identify::Block last = std::move(out.blocks.back());
    out.blocks.pop_back();
    out.blocks.back().insert(out.blocks.back().end(), last.begin(), last.end());
  }
  if (!out.rows.empty()) out.block_s = static_cast<double>(share) / design.rows_per_s();
  return out;
}

UsedRows MakeUsedRows(const identify::Design& design, int fewest_rows) {
  return MakeUsedRows(design, design.rows().UsedRows(), fewest_rows);
}

}  // namespace sinew::trace
