// Columns of the regression: effects evaluated along a recording, sent through the parallel filter
// and thinned to four rows per period of its cut-off. Pure but for what Columns keeps: one thread
// at a time. Allocates.
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/processing.h"

namespace sinew::identify {

// Clock of a recording in which nothing began yet, s.
inline constexpr double kLongBefore = -1e9;

// Properties of every row of the regression.
struct Rows {
  Eigen::VectorXd time_s;
  std::vector<int> run;
  std::vector<int> segment;
  std::vector<char> used;            // moving samples only
  std::vector<Eigen::Index> sample;  // index in its segment
  std::vector<int> window;           // empty, or as StateSegment::window
  Eigen::Index size() const { return time_s.size(); }
  std::vector<Eigen::Index> UsedRows() const;
  // Recording of a row, and number in its segment.
  std::size_t RunOf(Eigen::Index row) const {
    return static_cast<std::size_t>(run[static_cast<std::size_t>(row)]);
  }
  std::size_t SampleOf(Eigen::Index row) const {
    return static_cast<std::size_t>(sample[static_cast<std::size_t>(row)]);
  }
};

class Design {
 public:
  // options must be resolved.
  Design(StateSet states, const ProcessingOptions& options);

  const Rows& rows() const { return rows_; }
  const StateSet& states() const { return states_; }
  const StateSegment& SegmentOf(Eigen::Index row) const {
    return states_.segments[static_cast<std::size_t>(rows_.segment[static_cast<std::size_t>(row)])];
  }
  const ProcessingOptions& options() const { return options_; }
  double rows_per_s() const { return rows_per_s_; }  // of the first piece
  // Rows are holds (Run::held): their order says nothing, and no time runs between them.
  bool held() const { return !states_.segments.empty() && states_.segments.front().held; }

  // phi of an effect, a column per linear parameter. Kept for the next time where nothing that this
  // class changes is read (drive, clock): a design sees the effects of one joint.
  Eigen::MatrixXd Columns(const effects::Effect& effect, std::span<const double> psi) const;
  // phi of a drive effect with the drive input as it was measured.
  Eigen::VectorXd MeasuredDrive(const effects::Effect& drive) const;
  // Derivative of the torque of an arm's rigid bodies by their parameters (Run::rigid_columns),
  // filtered and thinned; no columns where the joint is no part of an arm.
  Eigen::MatrixXd RigidColumns() const;
  // A full-rate column, given per segment of the states, filtered and thinned like the columns.
  Eigen::VectorXd ThroughFilter(const std::vector<Eigen::VectorXd>& per_segment) const;
  // Any function of the sample: of every one, per segment of the states; filtered and thinned like
  // the columns.
  template <class Function>
  std::vector<Eigen::VectorXd> FullRate(Function f) const {
    std::vector<Eigen::VectorXd> out;
    for (const StateSegment& segment : states_.segments) {
      out.emplace_back(segment.size());
      for (Eigen::Index i = 0; i < segment.size(); ++i) {
        out.back()[i] = f(segment.samples[static_cast<std::size_t>(i)]);
      }
    }
    return out;
  }
  template <class Function>
  Eigen::VectorXd Column(Function f) const {
    Eigen::VectorXd out = ThroughFilter(FullRate(f));
    Centre(out);
    return out;
  }
  // The same without the filter: for plots and for variables.
  template <class Function>
  Eigen::VectorXd Variable(Function f) const {
    Eigen::VectorXd out(rows_.size());
    for (Eigen::Index i = 0; i < rows_.size(); ++i) {
      out[i] = f(SegmentOf(i).samples[rows_.SampleOf(i)]);
    }
    return out;
  }

  // Share of a signal's power behind the parallel filter (about its mean, used rows) that is noise,
  // taken as white and estimated by fourth differences from sample to sample. 1 for a signal that
  // is 0.
  template <class Function>
  double NoiseShare(Function f) const {
    return NoiseShare(FullRate(f), Column(f));
  }

  // From now on effects that read the drive see the drive that the model needs, not the measured
  // one: noise of the measured drive would stand on both sides of the equation.
  void PredictDrive(const actuator::JointModel& model);
  // Is the drive's rate that of the predicted drive, too, from the next prediction on? Else it is
  // that of the measured one behind the low-pass, where noise and what dry friction changes at once
  // is spread over the rows beside it; the predicted one has the noise of the jerk.
  void UsePredictedRate(bool predicted) { predicted_rate_ = predicted; }

  // Share of the rows whose torque no input of the model's drive gives, at the last prediction.
  double beyond_drive() const { return beyond_drive_; }

  // Moves the clock that effects see in one recording (JointSample::time_s, not Rows::time_s), so
  // that something that began at different instants begins at one instant of it: the clock shows
  // clock_s at each of the instants (rising, on the recording's stamps) and jumps halfway between
  // two of them; none: long before. Replaces an earlier setting.
  void SetClock(int run, const std::vector<double>& instants_s, double clock_s);
  // Turns the map of a shaft, cogging, in one recording: by so much its zero lies elsewhere.
  void SetMotorTurn(int run, double turn_rad);

  // Takes the mean over its used rows from every window. Columns that this class makes are so.
  void Centre(Eigen::Ref<Eigen::VectorXd> column) const;

 private:
  Eigen::Index Step(const StateSegment& segment) const;
  // Filters a full-rate column of a segment; returns the number of rows written.
  Eigen::Index Thin(const StateSegment& segment, const Eigen::VectorXd& full,
                    Eigen::Ref<Eigen::VectorXd> out) const;
  double NoiseShare(const std::vector<Eigen::VectorXd>& full,
                    const Eigen::VectorXd& filtered) const;
  Eigen::MatrixXd MakeColumns(const effects::Effect& effect, std::span<const double> psi) const;

  StateSet states_;
  ProcessingOptions options_;
  double rows_per_s_ = 1.0;
  Rows rows_;
  bool predicted_rate_ = false;
  double beyond_drive_ = 0.0;
  // Effect, its balance and psi.
  using Made = std::tuple<std::string, effects::Balance, std::vector<double>>;
  mutable std::map<Made, Eigen::MatrixXd> made_;
};

}  // namespace sinew::identify
