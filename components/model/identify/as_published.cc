#include "components/model/identify/as_published.h"

#include <Eigen/QR>
#include <array>
#include <stdexcept>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/uniform.h"

namespace sinew::identify {

namespace {

struct Regression {
  Eigen::MatrixXd columns;
  Eigen::VectorXd target;
  std::vector<std::pair<std::size_t, std::size_t>> parameters;  // term, linear
};

Regression Build(const types::Run& run, const actuator::JointModel& model,
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

  Regression out;
  std::vector<Eigen::VectorXd> full;
  std::vector<std::vector<Eigen::Index>> column_of(model.terms.size());
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    const actuator::Term& term = model.terms[t];
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      const bool known = term.linear[i].fixed || term.effect->info().role == effects::Role::kDrive;
      column_of[t].push_back(known ? -1 : static_cast<Eigen::Index>(full.size()));
      if (known) continue;
      full.push_back(Eigen::VectorXd::Zero(kept));
      out.parameters.emplace_back(t, i);
    }
  }
  Eigen::VectorXd target = Eigen::VectorXd::Zero(kept);
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
  for (Eigen::Index i = 0; i < kept; ++i) {
    effects::JointSample x;
    const Eigen::Index k = border + i;
    x.time_s = piece.Time(k);
    x.position_rad = q[k];
    x.velocity_rad_s = v[k];
    x.acceleration_rad_s2 = a[k];
    x.motor_position_rad = model.constants.gear_ratio * q[k];
    x.motor_velocity_rad_s = model.constants.gear_ratio * v[k];
    x.motor_acceleration_rad_s2 = model.constants.gear_ratio * a[k];
    x.drive_input = input[k];
    if (i == 0) {
      model.ResetMemory(x, memory);
    } else {
      model.Advance(x, piece.period_s, memory);
    }
    std::size_t at = 0;
    for (std::size_t t = 0; t < model.terms.size(); ++t) {
      const actuator::Term& term = model.terms[t];
      std::array<double, effects::kMaxParameters> phi{};
      const auto size = static_cast<std::size_t>(term.effect->memory_size());
      term.effect->Regressors(x, actuator::NonlinearValues(term), {memory.data() + at, size},
                              {phi.data(), term.linear.size()});
      at += size;
      for (std::size_t n = 0; n < term.linear.size(); ++n) {
        if (column_of[t][n] < 0) {
          target[i] += term.linear[n].value * phi[n];
        } else {
          full[static_cast<std::size_t>(column_of[t][n])][i] = -phi[n];
        }
      }
    }
  }
  out.target = Decimate(target, options.decimate);
  out.columns.resize(out.target.size(), static_cast<Eigen::Index>(full.size()));
  for (std::size_t c = 0; c < full.size(); ++c) {
    out.columns.col(static_cast<Eigen::Index>(c)) = Decimate(full[c], options.decimate);
  }
  return out;
}

double Percent(const Regression& regression, const Eigen::VectorXd& b) {
  return 100.0 * (regression.target - regression.columns * b).norm() / regression.target.norm();
}

void Fit(const types::Run& train, const types::Run& cross, const AsPublishedOptions& options,
         actuator::JointModel* model, double* percent, double* cross_percent) {
  const Regression regression = Build(train, *model, options);
  const Eigen::VectorXd b = regression.columns.colPivHouseholderQr().solve(regression.target);
  for (std::size_t i = 0; i < regression.parameters.size(); ++i) {
    const auto [term, linear] = regression.parameters[i];
    model->terms[term].linear[linear].value = b[static_cast<Eigen::Index>(i)];
  }
  *percent = Percent(regression, b);
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
