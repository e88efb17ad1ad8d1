#include "components/trace/units.h"

#include <algorithm>
#include <cmath>

#include "components/identify/statistics.h"

namespace sinew::trace {

namespace {
// The placebo gives whole units random signs: below this many, two of its patterns (all signs
// alike) come so often that the real gain is among the best false ones, and nothing could ever be
// accepted.
constexpr int kFewestUnits = 9;
constexpr int kFewestPeriods = 6;  // of a motion that counts as periodic
constexpr int kMostUnits = 120;
}  // namespace

double MotionPeriod(const identify::Design& design) {
  const identify::Rows& rows = design.rows();
  Eigen::VectorXd position =
      design.Variable([](const effects::JointSample& x) { return x.position_rad; });
  position.array() -= position.mean();
  const std::vector<char> all(static_cast<std::size_t>(rows.size()), 1);
  // At least six periods have to fit into the longest run.
  std::vector<Eigen::Index> length;
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const auto s = static_cast<std::size_t>(rows.segment[static_cast<std::size_t>(i)]);
    if (length.size() <= s) length.resize(s + 1, 0);
    ++length[s];
  }
  const auto longest = *std::max_element(length.begin(), length.end());
  const int last_lag = static_cast<int>(std::min<Eigen::Index>(longest / kFewestPeriods, 4000));
  if (last_lag < 8) return 0.0;
  const Eigen::VectorXd rho = identify::Autocorrelation(position, all, rows.segment, last_lag);
  bool fell = false;
  for (Eigen::Index lag = 1; lag + 1 < rho.size(); ++lag) {
    if (rho[lag] < 0.3) fell = true;
    if (fell && rho[lag] > 0.9 && rho[lag] >= rho[lag - 1] && rho[lag] >= rho[lag + 1]) {
      return static_cast<double>(lag) / design.rows_per_s();
    }
  }
  return 0.0;
}

Units ChooseUnits(const identify::Design& design, double correlation_time_s, int fewest_rows) {
  Units out;
  const identify::Rows& rows = design.rows();
  if (!rows.window.empty()) {
    out.blocks = identify::MakeWindowBlocks(rows, fewest_rows);
    out.kind = "window";
    return out;
  }
  if (design.states().run_names.size() >= kFewestUnits) {
    out.blocks = identify::MakeRunBlocks(rows);
    if (static_cast<int>(out.blocks.size()) >= kFewestUnits) {
      out.kind = "run";
      return out;
    }
  }
  double duration = 0.0;
  for (const identify::StateSegment& segment : design.states().segments) {
    duration += segment.period_s * static_cast<double>(segment.size());
  }
  out.gap_s = 0.5 * correlation_time_s;
  const double shortest = std::max({5.0 * correlation_time_s, duration / kMostUnits, 1.0});
  const double period = MotionPeriod(design);
  if (period > 0.0) {
    out.length_s = period * std::ceil(shortest / period);
    out.blocks = identify::MakeBlocks(rows, out.length_s, out.gap_s, fewest_rows);
    if (static_cast<int>(out.blocks.size()) >= kFewestUnits) {
      out.kind = "cycle";
      return out;
    }
  }
  out.kind = "block";
  out.length_s = shortest;
  out.blocks = identify::MakeBlocks(rows, out.length_s, out.gap_s, fewest_rows);
  return out;
}

}  // namespace sinew::trace
