#include "components/model/identify/uniform.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "components/base/types/median.h"

namespace sinew::identify {

namespace {

// Signals that keep their value until the next row.
bool IsSwitch(types::Signal signal) {
  return signal == types::Signal::kValveOpen || signal == types::Signal::kPayload ||
         signal == types::Signal::kReferencePosition || signal == types::Signal::kSupplyVoltage;
}

// Rows without a gap between them, and their grid.
struct Piece {
  Eigen::Index from = 0;               // its first row in the recording
  Eigen::VectorXd stamps, numbered{};  // instants: as recorded, by the grid
  UniformSegment segment;
  std::vector<Eigen::Index> rows{};        // grid point of each row
  double worst_s = 0.0, squares_s2 = 0.0;  // of the stamps against the grid
  bool stamps_only = false;
};

// Steps are whole periods.
void NumberRows(Piece* piece) {
  piece->rows.assign(static_cast<std::size_t>(piece->stamps.size()), 0);
  for (std::size_t i = 1; i < piece->rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double steps = (piece->stamps[k] - piece->stamps[k - 1]) / piece->segment.period_s;
    piece->rows[i] = piece->rows[i - 1] +
                     std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::llround(steps)));
  }
}

void FitLine(Piece* piece) {
  const std::vector<Eigen::Index>& rows = piece->rows;
  const double n = static_cast<double>(rows.size());
  double mean_k = 0.0, mean_t = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    mean_k += static_cast<double>(rows[i]) / n;
    mean_t += piece->stamps[static_cast<Eigen::Index>(i)] / n;
  }
  double kk = 0.0, kt = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double k = static_cast<double>(rows[i]) - mean_k;
    kk += k * k;
    kt += k * (piece->stamps[static_cast<Eigen::Index>(i)] - mean_t);
  }
  piece->segment.period_s = kt / kk;
  piece->segment.start_s = mean_t - piece->segment.period_s * mean_k;
}

void MeasureStamps(Piece* piece) {
  piece->worst_s = piece->squares_s2 = 0.0;
  piece->numbered.resize(piece->stamps.size());
  for (Eigen::Index i = 0; i < piece->stamps.size(); ++i) {
    piece->numbered[i] = piece->segment.Time(piece->rows[static_cast<std::size_t>(i)]);
    const double error_s = piece->stamps[i] - piece->numbered[i];
    piece->squares_s2 += error_s * error_s;
    piece->worst_s = std::max(piece->worst_s, std::abs(error_s));
  }
}

Piece FitPiece(const Eigen::VectorXd& time, Eigen::Index from, Eigen::Index count, double median) {
  Piece piece{.from = from, .stamps = time.segment(from, count), .segment = {.period_s = median}};
  for (int round = 0; round < 4; ++round) {
    NumberRows(&piece);
    FitLine(&piece);
  }
  MeasureStamps(&piece);
  // Rows that no even count explains (the logger changed its rate, or never had one): stamps
  // alone give the instants, and a row's number is that of the nearest grid point.
  UniformSegment& segment = piece.segment;
  piece.stamps_only =
      piece.squares_s2 > 0.25 * segment.period_s * segment.period_s * static_cast<double>(count);
  if (!piece.stamps_only) return piece;
  segment.start_s = piece.stamps[0];
  segment.period_s = median;
  for (Eigen::Index i = 0; i < count; ++i) {
    piece.rows[static_cast<std::size_t>(i)] = static_cast<Eigen::Index>(
        std::llround((piece.stamps[i] - segment.start_s) / segment.period_s));
  }
  MeasureStamps(&piece);
  return piece;
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

Eigen::VectorXd GridTimes(const UniformSegment& segment) {
  Eigen::VectorXd grid(segment.size());
  for (Eigen::Index i = 0; i < grid.size(); ++i) grid[i] = segment.Time(i);
  return grid;
}

// The stamps are the true instants, rather than the row numbers: they make the position smoother.
bool StampsAreSmoother(const types::Run& run, const Piece& piece) {
  const Eigen::VectorXd grid = GridTimes(piece.segment);
  for (const types::Signal signal : {types::Signal::kMotorPosition, types::Signal::kPosition}) {
    if (!run.Has(signal)) continue;
    const Eigen::VectorXd values = run.At(signal).segment(piece.from, piece.stamps.size());
    return Roughness(SplineAt(piece.stamps, values, grid)) <
           1.5 * Roughness(SplineAt(piece.numbered, values, grid));
  }
  return true;
}

// Signals on the grid, from rows that were sampled at the given instants.
void Resample(const types::Run& run, const Eigen::VectorXd& at, Piece* piece) {
  UniformSegment& segment = piece->segment;
  const Eigen::VectorXd grid = GridTimes(segment);
  for (const auto& [signal, values] : run.signals) {
    const Eigen::VectorXd own = values.segment(piece->from, at.size());
    segment.signals[signal] = IsSwitch(signal) ? HoldAt(at, own, grid) : SplineAt(at, own, grid);
  }
  segment.row.assign(segment.valid.size(), -1);
  segment.sampled_s = grid;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const Eigen::Index k = piece->rows[static_cast<std::size_t>(i)];
    segment.row[static_cast<std::size_t>(k)] = piece->from + i;
    segment.sampled_s[k] = at[i];
  }
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
  out.sampling.even = true;
  const double gap = std::max(longest_gap_s, 4.0 * median);

  double rate_sum = 0.0;
  double rate_rows = 0.0;
  bool decided = false;
  for (Eigen::Index first = 0; first < time.size();) {
    Eigen::Index last = first;
    while (last + 1 < time.size() && steps[last] <= gap) ++last;
    const Eigen::Index count = last - first + 1;
    const Eigen::Index from = std::exchange(first, last + 1);
    if (count < fewest_rows) continue;
    Piece piece = FitPiece(time, from, count, median);
    UniformSegment& segment = piece.segment;
    rate_sum += static_cast<double>(count) / segment.period_s;
    rate_rows += static_cast<double>(count);
    segment.valid.assign(static_cast<std::size_t>(piece.rows.back() + 1), 1);
    const bool even = piece.worst_s < 1e-3 * segment.period_s && segment.size() == count;
    out.sampling.even = out.sampling.even && even;
    // Between two rows; where only stamps count, one grid point without a row is no loss.
    const Eigen::Index hole = piece.stamps_only ? 3 : 2;
    for (std::size_t i = 0; i + 1 < piece.rows.size(); ++i) {
      const Eigen::Index step = piece.rows[i + 1] - piece.rows[i];
      if (step < hole) continue;
      out.sampling.lost_rows += step - 1;
      if (!even) std::fill_n(segment.valid.begin() + piece.rows[i], step + 1, 0);  // and its rims
    }
    if (even) {
      for (const auto& [signal, values] : run.signals) {
        segment.signals[signal] = values.segment(from, count);
      }
    } else {
      if (piece.stamps_only || !decided) {
        out.sampling.stamps_used = piece.stamps_only || StampsAreSmoother(run, piece);
        decided = true;
      }
      Resample(run, out.sampling.stamps_used ? piece.stamps : piece.numbered, &piece);
    }
    out.segments.push_back(std::move(segment));
  }
  if (out.segments.empty()) {
    throw TooLittleData("recording " + run.name + " has no piece of " +
                        std::to_string(fewest_rows) + " rows without a gap");
  }
  out.sampling.rate_Hz = rate_sum / rate_rows;
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
  return SplineAt(GridTimes(segment), smooth, segment.sampled_s);
}

}  // namespace sinew::identify
