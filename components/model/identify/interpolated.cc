#include "components/model/identify/interpolated.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "components/model/identify/statistics.h"

namespace sinew::identify {

namespace {

constexpr int kMostRows = 10;
constexpr Eigen::Index kFewest = 50;  // rows with motion of each kind
// A digit that a file leaves out, of a typical step. Measured noise lies as near to the line once
// in a thousand rows.
constexpr double kRounding = 1e-3;
// Shares of rows on the line: almost all of one kind, almost none of the other.
constexpr double kAlmostAll = 0.95, kAlmostNone = 0.05;

enum class Kind : char { kStill, kOnLine, kMeasured };

// A row at which nothing changes says nothing.
std::vector<Kind> KindsOf(const types::Run& run) {
  std::vector<Kind> out(static_cast<std::size_t>(run.size()), Kind::kStill);
  for (const auto& [signal, x] : run.signals) {
    const Eigen::Index n = x.size();
    if (n < 3) continue;
    const double rounding = kRounding * Rms(x.tail(n - 1) - x.head(n - 1));
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      Kind& kind = out[static_cast<std::size_t>(i)];
      if (x[i - 1] == x[i] && x[i] == x[i + 1]) continue;
      const double along =
          (run.time_s[i] - run.time_s[i - 1]) / (run.time_s[i + 1] - run.time_s[i - 1]);
      const double line = x[i - 1] + along * (x[i + 1] - x[i - 1]);
      if (std::abs(x[i] - line) > rounding) {
        kind = Kind::kMeasured;
      } else if (kind == Kind::kStill) {
        kind = Kind::kOnLine;
      }
    }
  }
  return out;
}

// Row of the first measured one, if one of m was; -1: no.
Eigen::Index FirstMeasured(const std::vector<Kind>& kinds, int m) {
  for (int first = 0; first < m; ++first) {
    double on_line[2] = {0.0, 0.0}, all[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      if (kinds[i] == Kind::kStill) continue;
      const int between = static_cast<int>(i) % m == first ? 0 : 1;
      all[between] += 1.0;
      on_line[between] += kinds[i] == Kind::kOnLine ? 1.0 : 0.0;
    }
    if (std::min(all[0], all[1]) < static_cast<double>(kFewest)) continue;
    if (on_line[0] < kAlmostNone * all[0] && on_line[1] > kAlmostAll * all[1]) return first;
  }
  return -1;
}

// The number of rows of which one was measured, 1: all of them, and the first that was.
std::pair<int, Eigen::Index> PatternOf(const types::Run& run) {
  if (run.held) return {1, 0};
  const std::vector<Kind> kinds = KindsOf(run);
  for (int m = 2; m <= kMostRows; ++m) {
    const Eigen::Index first = FirstMeasured(kinds, m);
    if (first >= 0) return {m, first};
  }
  return {1, 0};
}

}  // namespace

types::Run WithRows(types::Run run, const std::vector<Eigen::Index>& rows) {
  run.time_s = run.time_s(rows).eval();
  for (auto& [signal, x] : run.signals) x = x(rows).eval();
  return run;
}

types::Run WithoutInterpolatedRows(types::Run run) {
  const auto [m, first] = PatternOf(run);
  if (m == 1) return run;
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = first; i < run.size(); i += m) rows.push_back(i);
  run.interpolated_rows = run.size() - static_cast<Eigen::Index>(rows.size());
  return WithRows(std::move(run), rows);
}

}  // namespace sinew::identify
