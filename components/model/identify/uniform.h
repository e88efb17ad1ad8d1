// Recordings with jittering stamps and lost rows, brought onto an even time grid.
//
// A recording is cut where it has a gap longer than `longest_gap_s`; each piece gets a grid of its
// own with the recording's period (the median step, refined by a straight line through the stamps).
// Rows that lie on the grid already are copied bit by bit. Otherwise continuous signals go through
// a natural cubic spline over the stamps, switches keep their last value, and grid points inside a
// hole of lost rows are marked as not valid. Whether the stamps or the row numbers give the true
// sampling instants is decided by the position: the truth makes it smoother. Where no even count of
// rows explains the stamps (a logger that changes its rate), the stamps alone count.
// Pure; allocates; throws TooLittleData for a recording that is too short.
#pragma once

#include <Eigen/Core>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/types/run.h"

namespace sinew::identify {

// Recordings that are well formed, but too short or with too little motion for the request. The
// caller reports it as a result; it is no usage error.
struct TooLittleData : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

struct UniformSegment {
  double start_s = 0.0;
  double period_s = 0.0;
  std::map<types::Signal, Eigen::VectorXd> signals;
  std::vector<char> valid;  // 0: inside a hole of lost rows
  // Row of the recording that belongs to each grid point (-1: none) and the instant at which it was
  // sampled, as far as is known; both empty where rows lie on the grid already.
  std::vector<Eigen::Index> row;
  Eigen::VectorXd sampled_s;

  Eigen::Index size() const { return static_cast<Eigen::Index>(valid.size()); }
  double Time(Eigen::Index i) const { return start_s + period_s * static_cast<double>(i); }
  double rate_Hz() const { return 1.0 / period_s; }
};

// A signal as its rows were recorded, in the order of the grid; lost rows from the spline.
Eigen::VectorXd AsMeasured(const types::Run& run, const UniformSegment& segment,
                           types::Signal signal);
// A smooth signal of the grid at the instants of the rows.
Eigen::VectorXd AtRows(const UniformSegment& segment, const Eigen::VectorXd& smooth);

// The position of the output, from the motor where only that was recorded; throws
// std::invalid_argument with the recording's name where neither was.
Eigen::VectorXd OutputPosition(const UniformSegment& segment, double gear_ratio,
                               const std::string& name);

struct SamplingReport {
  double rate_Hz = 0.0;
  Eigen::Index lost_rows = 0;  // inside pieces
  bool even = false;           // rows were copied
  bool stamps_used = true;     // false: row numbers were smoother
};

struct UniformRun {
  std::vector<UniformSegment> segments;
  SamplingReport sampling;
};

// fewest_rows: shorter pieces are dropped; filters and derivatives need some to settle.
UniformRun MakeUniform(const types::Run& run, double longest_gap_s = 0.25, int fewest_rows = 100);

// Natural cubic spline through (x, y), x strictly increasing, evaluated at the rising points `at`;
// outside of x it continues with the end values. At least 3 points.
Eigen::VectorXd SplineAt(const Eigen::Ref<const Eigen::VectorXd>& x,
                         const Eigen::Ref<const Eigen::VectorXd>& y,
                         const Eigen::Ref<const Eigen::VectorXd>& at);

}  // namespace sinew::identify
