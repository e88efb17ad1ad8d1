#include "components/model/identify/uniform.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/median.h"
#include "components/model/identify/too_little_data.h"

namespace sinew::identify {

namespace {

// Signals that keep their value until the next row.
bool IsSwitch(types::Signal signal) {
  return signal == types::Signal::kValveOpen || signal == types::Signal::kPayload ||
         signal == types::Signal::kReferencePosition || signal == types::Signal::kSupplyVoltage;
}

// Row numbers on the grid: steps are whole periods.
std::vector<Eigen::Index> RowNumbers(const Eigen::VectorXd& time, Eigen::Index first,
                                     Eigen::Index count, double period) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(count));
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (i > 0) {
      const double steps = (time[first + i] - time[first + i - 1]) / period;
      row += std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::llround(steps)));
    }
    rows[static_cast<std::size_t>(i)] = row;
  }
  return rows;
}

struct Line {
  double start = 0.0;
  double period = 0.0;
};

Line FitLine(const Eigen::VectorXd& time, Eigen::Index first,
             const std::vector<Eigen::Index>& rows) {
  const double n = static_cast<double>(rows.size());
  double mean_k = 0.0;
  double mean_t = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    mean_k += static_cast<double>(rows[i]) / n;
    mean_t += time[first + static_cast<Eigen::Index>(i)] / n;
  }
  double kk = 0.0;
  double kt = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double k = static_cast<double>(rows[i]) - mean_k;
    kk += k * k;
    kt += k * (time[first + static_cast<Eigen::Index>(i)] - mean_t);
  }
  const double period = kt / kk;
  return {mean_t - period * mean_k, period};
}

// A measure of roughness: mean square fourth difference.
double Roughness(const Eigen::VectorXd& x) {
  if (x.size() < 6) return 0.0;
  const Eigen::Index n = x.size() - 4;
  const Eigen::VectorXd d = x.segment(0, n) - 4.0 * x.segment(1, n) + 6.0 * x.segment(2, n) -
                            4.0 * x.segment(3, n) + x.segment(4, n);
  return d.squaredNorm() / static_cast<double>(n);
}

Eigen::VectorXd HoldAt(const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                       const Eigen::VectorXd& at) {
  Eigen::VectorXd out(at.size());
  Eigen::Index k = 0;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    while (k + 1 < x.size() && x[k + 1] <= at[i]) ++k;
    out[i] = y[k];
  }
  return out;
}

}  // namespace

Eigen::VectorXd SplineAt(const Eigen::Ref<const Eigen::VectorXd>& x,
                         const Eigen::Ref<const Eigen::VectorXd>& y,
                         const Eigen::Ref<const Eigen::VectorXd>& at) {
  const Eigen::Index n = x.size();
  if (n < 3 || y.size() != n) throw std::invalid_argument("spline needs at least 3 points");
  // Second derivatives m by the tridiagonal system of the natural spline.
  Eigen::VectorXd m = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd upper = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double h0 = x[i] - x[i - 1];
    const double h1 = x[i + 1] - x[i];
    const double right = 6.0 * ((y[i + 1] - y[i]) / h1 - (y[i] - y[i - 1]) / h0);
    const double pivot = 2.0 * (h0 + h1) - h0 * upper[i - 1];
    upper[i] = h1 / pivot;
    m[i] = (right - h0 * m[i - 1]) / pivot;
  }
  for (Eigen::Index i = n - 2; i >= 1; --i) m[i] -= upper[i] * m[i + 1];

  Eigen::VectorXd out(at.size());
  Eigen::Index k = 0;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    if (at[i] <= x[0]) {
      out[i] = y[0];
      continue;
    }
    if (at[i] >= x[n - 1]) {
      out[i] = y[n - 1];
      continue;
    }
    while (k + 2 < n && x[k + 1] <= at[i]) ++k;
    const double h = x[k + 1] - x[k];
    const double a = (x[k + 1] - at[i]) / h;
    const double b = 1.0 - a;
    out[i] = a * y[k] + b * y[k + 1] +
             ((a * a * a - a) * m[k] + (b * b * b - b) * m[k + 1]) * h * h / 6.0;
  }
  return out;
}

Eigen::VectorXd OutputPosition(const UniformSegment& segment, double gear_ratio,
                               const std::string& name) {
  const auto output = segment.signals.find(types::Signal::kPosition);
  if (output != segment.signals.end()) return output->second;
  const auto motor = segment.signals.find(types::Signal::kMotorPosition);
  if (motor != segment.signals.end()) return motor->second / gear_ratio;
  throw std::invalid_argument("recording " + name + " has no signal 'position'");
}

UniformRun MakeUniform(const types::Run& run, double longest_gap_s, int fewest_rows) {
  const Eigen::VectorXd& time = run.time_s;
  if (time.size() < 20) {
    throw TooLittleData("recording " + run.name + " has " + std::to_string(time.size()) +
                        " rows, expected at least 20");
  }
  const Eigen::VectorXd steps = time.tail(time.size() - 1) - time.head(time.size() - 1);
  const double median = types::UpperMedian(std::vector<double>(steps.begin(), steps.end()));
  UniformRun out;
  out.sampling.longest_step_s = steps.maxCoeff();
  out.sampling.even = true;
  const double gap = std::max(longest_gap_s, 4.0 * median);

  double rate_sum = 0.0;
  double rate_rows = 0.0;
  double jitter_squares = 0.0;
  bool decided = false;
  for (Eigen::Index first = 0; first < time.size();) {
    Eigen::Index last = first;
    while (last + 1 < time.size() && steps[last] <= gap) ++last;
    const Eigen::Index count = last - first + 1;
    const Eigen::Index from = first;
    first = last + 1;
    if (count < fewest_rows) {
      out.sampling.dropped_rows += count;
      continue;
    }
    std::vector<Eigen::Index> rows = RowNumbers(time, from, count, median);
    Line line = FitLine(time, from, rows);
    for (int round = 0; round < 3; ++round) {
      rows = RowNumbers(time, from, count, line.period);
      line = FitLine(time, from, rows);
    }
    double worst = 0.0;
    double squares = 0.0;
    const auto measure = [&] {
      worst = squares = 0.0;
      for (Eigen::Index i = 0; i < count; ++i) {
        const double error =
            time[from + i] -
            (line.start + line.period * static_cast<double>(rows[static_cast<std::size_t>(i)]));
        squares += error * error;
        worst = std::max(worst, std::abs(error));
      }
    };
    measure();
    // Rows that no even count explains (the logger changed its rate, or never had one): stamps
    // alone give the instants, and a row's number is that of the nearest grid point.
    const bool stamps_only =
        squares > 0.25 * line.period * line.period * static_cast<double>(count);
    if (stamps_only) {
      line = {time[from], median};
      for (Eigen::Index i = 0; i < count; ++i) {
        rows[static_cast<std::size_t>(i)] =
            static_cast<Eigen::Index>(std::llround((time[from + i] - line.start) / line.period));
      }
      measure();
    }
    jitter_squares += squares;
    const Eigen::Index size = rows.back() + 1;
    rate_sum += static_cast<double>(count) / line.period;
    rate_rows += static_cast<double>(count);
    // Between two rows; where only stamps count, one grid point without a row is no loss.
    const Eigen::Index hole = stamps_only ? 3 : 2;
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      const Eigen::Index step = rows[i + 1] - rows[i];
      if (step >= hole) out.sampling.lost_rows += step - 1;
    }

    UniformSegment segment;
    segment.start_s = line.start;
    segment.period_s = line.period;
    segment.valid.assign(static_cast<std::size_t>(size), 1);
    const bool even = worst < 1e-3 * line.period && size == count;
    out.sampling.even = out.sampling.even && even;
    if (even) {
      for (const auto& [signal, values] : run.signals) {
        segment.signals[signal] = values.segment(from, count);
      }
      out.segments.push_back(std::move(segment));
      continue;
    }
    Eigen::VectorXd grid(size);
    for (Eigen::Index i = 0; i < size; ++i) grid[i] = segment.Time(i);
    const Eigen::VectorXd stamps = time.segment(from, count);
    Eigen::VectorXd numbered(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      numbered[i] = segment.Time(rows[static_cast<std::size_t>(i)]);
    }
    if (stamps_only) {
      out.sampling.stamps_used = decided = true;
    } else if (!decided) {
      decided = true;
      for (const types::Signal signal : {types::Signal::kMotorPosition, types::Signal::kPosition}) {
        if (!run.Has(signal)) continue;
        const Eigen::VectorXd values = run.At(signal).segment(from, count);
        out.sampling.stamps_used = Roughness(SplineAt(stamps, values, grid)) <
                                   1.5 * Roughness(SplineAt(numbered, values, grid));
        break;
      }
    }
    const Eigen::VectorXd& at = out.sampling.stamps_used ? stamps : numbered;
    for (const auto& [signal, values] : run.signals) {
      const Eigen::VectorXd piece = values.segment(from, count);
      segment.signals[signal] =
          IsSwitch(signal) ? HoldAt(at, piece, grid) : SplineAt(at, piece, grid);
    }
    segment.row.assign(static_cast<std::size_t>(size), -1);
    segment.sampled_s = grid;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(rows[static_cast<std::size_t>(i)]);
      segment.row[k] = from + i;
      segment.sampled_s[static_cast<Eigen::Index>(k)] = at[i];
    }
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {  // holes and their rims
      if (rows[i + 1] - rows[i] < hole) continue;
      for (Eigen::Index k = rows[i]; k <= rows[i + 1]; ++k) {
        segment.valid[static_cast<std::size_t>(k)] = 0;
      }
    }
    out.segments.push_back(std::move(segment));
  }
  if (out.segments.empty()) {
    throw TooLittleData("recording " + run.name + " has no piece of " +
                        std::to_string(fewest_rows) + " rows without a gap");
  }
  out.sampling.rate_Hz = rate_sum / rate_rows;
  out.sampling.jitter_rms_s = std::sqrt(jitter_squares / rate_rows);
  return out;
}

Eigen::VectorXd AsMeasured(const types::Run& run, const UniformSegment& segment,
                           types::Signal signal) {
  Eigen::VectorXd out = segment.signals.at(signal);
  if (segment.row.empty()) return out;
  const Eigen::VectorXd& rows = run.At(signal);
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const Eigen::Index row = segment.row[static_cast<std::size_t>(i)];
    if (row >= 0) out[i] = rows[row];
  }
  return out;
}

Eigen::VectorXd AtRows(const UniformSegment& segment, const Eigen::VectorXd& smooth) {
  if (segment.row.empty() || smooth.size() == 0) return smooth;
  Eigen::VectorXd grid(segment.size());
  for (Eigen::Index i = 0; i < grid.size(); ++i) grid[i] = segment.Time(i);
  return SplineAt(grid, smooth, segment.sampled_s);
}

}  // namespace sinew::identify
