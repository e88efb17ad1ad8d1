#include "components/model/identify/as_published.h"

#include <Eigen/QR>
#include <stdexcept>
#include <utility>

#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/uniform.h"

namespace sinew::identify {

namespace {

// The balance behind the published filters, decimated.
Balance Build(const types::Run& run, const actuator::JointModel& model,
              const AsPublishedOptions& options) {
  const types::Signal drive = DriveSignal(model);
  run.At(drive);
  const UniformRun uniform = MakeUniform(run);
  if (uniform.segments.size() != 1) {
    throw std::invalid_argument("recording " + run.name +
                                " has gaps, the published processing none");
  }
  const UniformSegment& piece = uniform.segments.front();
  const auto position = piece.signals.find(types::Signal::kPosition);
  if (position == piece.signals.end()) run.At(types::Signal::kPosition);
  const Eigen::Index border = options.border_samples;
  const Eigen::Index kept = piece.size() - 2 * border;
  if (kept < 10 * options.decimate) {
    throw std::invalid_argument("recording " + run.name +
                                " is too short for the published processing");
  }
  const Eigen::VectorXd q =
      FilterZeroPhase(ButterworthLowPass(options.filter_order, options.cutoff_Hz, piece.rate_Hz()),
                      position->second);
  const Eigen::VectorXd v = CentralDifference(q, piece.period_s);
  const Eigen::VectorXd a = CentralDifference(v, piece.period_s);
  const Eigen::VectorXd& input = piece.signals.at(drive);

  StateSegment segment{.start_s = piece.Time(border), .period_s = piece.period_s};
  segment.drive_input = input.segment(border, kept);
  segment.usable.assign(static_cast<std::size_t>(kept), 1);
  for (Eigen::Index k = border; k < border + kept; ++k) {
    effects::JointSample& x = segment.samples.emplace_back();
    x.time_s = piece.Time(k);
    x.position_rad = q[k];
    x.velocity_rad_s = v[k];
    x.acceleration_rad_s2 = a[k];
    x.motor_position_rad = model.constants.gear_ratio * q[k];
    x.motor_velocity_rad_s = model.constants.gear_ratio * v[k];
    x.motor_acceleration_rad_s2 = model.constants.gear_ratio * a[k];
    x.drive_input = input[k];
  }
  StateSet states;
  states.segments.push_back(std::move(segment));
  const Design design(std::move(states), Unfiltered({}, piece.rate_Hz()));
  Balance out = MakeBalance(design, model, false);
  const Eigen::MatrixXd full = std::move(out.columns);
  out.target = Decimate(out.target, options.decimate);
  out.columns.resize(out.target.size(), full.cols());
  for (Eigen::Index c = 0; c < full.cols(); ++c) {
    out.columns.col(c) = Decimate(full.col(c), options.decimate);
  }
  return out;
}

double Percent(const Balance& balance, const Eigen::VectorXd& b) {
  return 100.0 * (balance.target - balance.columns * b).norm() / balance.target.norm();
}

void Fit(const types::Run& train, const types::Run& cross, const AsPublishedOptions& options,
         actuator::JointModel* model, double* percent, double* cross_percent) {
  const Balance balance = Build(train, *model, options);
  const Eigen::VectorXd b = balance.columns.colPivHouseholderQr().solve(balance.target);
  balance.Apply(b, model);
  *percent = Percent(balance, b);
  *cross_percent = Percent(Build(cross, *model, options), b);
}

}  // namespace

AsPublishedResult RunAsPublished(const types::Run& train, const types::Run& cross,
                                 const actuator::JointModel& model,
                                 const AsPublishedOptions& options) {
  AsPublishedResult out;
  out.before = model;
  Fit(train, cross, options, &out.before, &out.before_percent, &out.cross_before_percent);
  out.after = model;
  for (const std::string& name : options.added_effects) {
    actuator::Term term = actuator::MakeTerm(name, model.constants);
    term.declared = false;
    out.after.terms.push_back(std::move(term));
  }
  Fit(train, cross, options, &out.after, &out.after_percent, &out.cross_after_percent);
  return out;
}

}  // namespace sinew::identify
