#include "components/model/shooting/shooting_fit.h"

#include <ceres/cost_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/model/identify/statistics.h"
#include "components/model/trace/machine_size.h"

namespace sinew::shooting {

namespace {

using Blocks = std::vector<double*>;

constexpr int kMostIterations = 30;
// Relative change of the cost: of the pass that finds how loud the rows are, and of the last one.
constexpr double kRough = 1e-3, kConverged = 1e-5;
// Unit of a value without tolerance, and of the shape of an added term, share of the value.
constexpr double kScale = 0.3;

actuator::JointModel WithValues(actuator::JointModel model,
                                const std::vector<Parameter>& parameters, const double* counts) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    ValueOf(parameters[i], &model) = parameters[i].mean + parameters[i].scale * counts[i];
  }
  return model;
}

struct Loudness {
  double row = 1.0, gap = 1.0;  // rad (m); prior deviations
};

// One piece: rows over their noise, then the gap to the next piece where it continues. Its blocks
// of parameters, in this order, those that are there: the model's, the recording's zero, its state,
// the state of the next piece.
class PieceCost final : public ceres::CostFunction {
 public:
  PieceCost(const Recordings& recordings, const actuator::JointModel& model,
            const std::vector<Parameter>& parameters, std::size_t piece, const Loudness& loud,
            bool zero)
      : recordings_(recordings),
        model_(model),
        parameters_(parameters),
        piece_(piece),
        loud_(loud),
        zero_(zero) {
    const Piece& p = recordings.pieces()[piece];
    const auto states = static_cast<int>(recordings.deviation().size());
    auto* sizes = mutable_parameter_block_sizes();
    if (!parameters.empty()) sizes->push_back(static_cast<int>(parameters.size()));
    if (zero) sizes->push_back(1);
    sizes->push_back(states);
    if (p.continues) sizes->push_back(states);
    set_num_residuals(static_cast<int>(p.count) + (p.continues ? 2 : 0));
  }

  // False: such a model cannot be simulated (no inertia is left), a shorter step may.
  bool Evaluate(double const* const* given, double* residuals, double** jacobians) const override {
    try {
      Differentiate(given, residuals, jacobians);
    } catch (const std::invalid_argument&) {
      return false;
    }
    return true;
  }

 private:
  void Differentiate(double const* const* given, double* residuals, double** jacobians) const {
    const std::vector<int>& sizes = parameter_block_sizes();
    std::vector<std::vector<double>> at;
    for (std::size_t b = 0; b < sizes.size(); ++b) at.emplace_back(given[b], given[b] + sizes[b]);
    const Eigen::VectorXd base = Residuals(at);
    std::copy(base.begin(), base.end(), residuals);
    if (jacobians == nullptr) return;
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
          jacobians[b], num_residuals(), sizes[b]);
      if (b == NextBlock()) {
        J.setZero();
        J.bottomLeftCorner(2, 2) = -Eigen::Matrix2d::Identity() / loud_.gap;
        continue;
      }
      for (int k = 0; k < sizes[b]; ++k) {
        double& value = at[b][static_cast<std::size_t>(k)];
        value += kDifference;
        J.col(k) = (Residuals(at) - base) / kDifference;
        value -= kDifference;
      }
    }
  }

  const Piece& piece() const { return recordings_.pieces()[piece_]; }
  std::size_t NextBlock() const {
    return piece().continues ? parameter_block_sizes().size() - 1 : parameter_block_sizes().size();
  }

  Eigen::VectorXd Residuals(const std::vector<std::vector<double>>& at) const {
    const Piece& p = piece();
    std::size_t block = 0;
    const actuator::JointModel model =
        parameters_.empty() ? model_ : WithValues(model_, parameters_, at[block++].data());
    const double zero_rad = zero_ ? at[block++][0] * recordings_.zero_deviation()[p.run] : 0.0;
    const auto vector = [&](const std::vector<double>& values) {
      return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                               static_cast<Eigen::Index>(values.size()));
    };
    const Path path = recordings_.Simulate(model, piece_, vector(at[block]), zero_rad);
    Eigen::VectorXd out(num_residuals());
    out.head(p.count) = (path.angle - recordings_.measured().segment(p.row, p.count)) / loud_.row;
    if (p.continues) out.tail<2>() = recordings_.Gap(piece_, path, vector(at.back())) / loud_.gap;
    return out;
  }

  const Recordings& recordings_;
  const actuator::JointModel& model_;
  const std::vector<Parameter>& parameters_;
  std::size_t piece_;
  Loudness loud_;
  bool zero_;
};

// Values that are free, as counts.
struct Unknowns {
  std::vector<double> parameters, zeros;
  Eigen::MatrixXd states;
};

void AddPrior(double* block, Eigen::Index size, const Eigen::VectorXd& precision,
              ceres::Problem* problem) {
  problem->AddResidualBlock(
      new ceres::NormalPrior(Eigen::MatrixXd(precision.asDiagonal()), Eigen::VectorXd::Zero(size)),
      nullptr, block);
}

void AddPriors(const Recordings& recordings, const std::vector<Parameter>& parameters, Unknowns* at,
               ceres::Problem* problem) {
  if (!parameters.empty()) {
    Eigen::VectorXd precision(static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Parameter& p = parameters[i];
      const auto k = static_cast<int>(i);
      precision[k] = p.precision;
      if (std::isfinite(p.lower)) {
        problem->SetParameterLowerBound(at->parameters.data(), k, (p.lower - p.mean) / p.scale);
      }
      if (std::isfinite(p.upper)) {
        problem->SetParameterUpperBound(at->parameters.data(), k, (p.upper - p.mean) / p.scale);
      }
    }
    AddPrior(at->parameters.data(), precision.size(), precision, problem);
  }
  for (std::size_t r = 0; r < at->zeros.size(); ++r) {
    if (problem->HasParameterBlock(&at->zeros[r])) {
      AddPrior(&at->zeros[r], 1, Eigen::VectorXd::Ones(1), problem);
    }
  }
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(recordings.deviation().size());
  for (Eigen::Index p = 0; p < at->states.cols(); ++p) {
    double* state = at->states.col(p).data();
    AddPrior(state, ones.size(), ones, problem);
  }
}

void Solve(const Recordings& recordings, const actuator::JointModel& model,
           const std::vector<Parameter>& parameters, const Loudness& loud, double converged,
           Unknowns* at) {
  ceres::Problem problem;
  for (std::size_t p = 0; p < recordings.pieces().size(); ++p) {
    const Piece& piece = recordings.pieces()[p];
    const bool zero = recordings.zero_deviation()[piece.run] > 0.0;
    Blocks blocks;
    if (!parameters.empty()) blocks.push_back(at->parameters.data());
    if (zero) blocks.push_back(&at->zeros[static_cast<std::size_t>(piece.run)]);
    blocks.push_back(at->states.col(static_cast<Eigen::Index>(p)).data());
    if (piece.continues) {
      blocks.push_back(at->states.col(static_cast<Eigen::Index>(p) + 1).data());
    }
    problem.AddResidualBlock(new PieceCost(recordings, model, parameters, p, loud, zero), nullptr,
                             blocks);
  }
  AddPriors(recordings, parameters, at, &problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = kMostIterations;
  options.function_tolerance = converged;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

// Rows at least as loud as their sums over pieces.
Loudness LoudnessOf(const Recordings& recordings, const Eigen::VectorXd& residual,
                    const Eigen::VectorXd& gaps) {
  double sums = 0.0;
  for (const Piece& p : recordings.pieces()) {
    const double sum = residual.segment(p.row, p.count).sum();
    sums += sum * sum;
  }
  return {std::max({recordings.noise_rad(), identify::Rms(residual),
                    std::sqrt(sums / static_cast<double>(recordings.rows()))}),
          std::max(1.0, identify::Rms(gaps))};
}

Fit FitUnknowns(const Recordings& recordings, const actuator::JointModel& model,
                const std::vector<Parameter>& parameters) {
  Unknowns at;
  for (const Parameter& p : parameters) {
    actuator::JointModel copy = model;
    at.parameters.push_back((std::clamp(ValueOf(p, &copy), p.lower, p.upper) - p.mean) / p.scale);
  }
  Fit out;
  out.start = recordings.Measured();
  at.zeros.assign(static_cast<std::size_t>(out.start.zero_rad.size()), 0.0);
  at.states = out.start.state;
  Loudness loud{recordings.noise_rad(), 1.0};
  constexpr int kPasses = 2;
  for (int pass = 0; pass < kPasses; ++pass) {
    Solve(recordings, model, parameters, loud, pass == 0 ? kRough : kConverged, &at);
    out.model = WithValues(model, parameters, at.parameters.data());
    out.start.state = at.states;
    for (std::size_t r = 0; r < at.zeros.size(); ++r) {
      const auto k = static_cast<Eigen::Index>(r);
      out.start.zero_rad[k] = at.zeros[r] * recordings.zero_deviation()[k];
    }
    const Eigen::VectorXd stacked = recordings.Stacked(out.model, out.start);
    out.residual = stacked.head(recordings.rows()) - recordings.measured();
    out.rms = identify::Rms(out.residual);
    loud = LoudnessOf(recordings, out.residual, stacked.tail(stacked.size() - recordings.rows()));
  }
  return out;
}

}  // namespace

double& ValueOf(const Parameter& parameter, actuator::JointModel* model) {
  actuator::Term& term = model->terms[static_cast<std::size_t>(parameter.term)];
  const auto i = static_cast<std::size_t>(parameter.index);
  return (parameter.nonlinear ? term.nonlinear : term.linear)[i].value;
}

std::vector<Parameter> FreeParameters(const Recordings& recordings,
                                      const actuator::JointModel& model,
                                      const actuator::JointModel& declared) {
  std::vector<Parameter> out;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    const actuator::Term& term = model.terms[t];
    if (!model.Counts(term)) continue;
    const effects::EffectInfo& info = term.effect->info();
    const bool added = t >= declared.terms.size();
    const auto number = static_cast<int>(t);
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      if (term.linear[i].fixed) continue;
      const trace::Range range = trace::RangeOnAnyMachine(info.linear[i]);
      Parameter p{number, static_cast<int>(i), false,      term.linear[i].value, 0.0,
                  0.0,    range.lower,         range.upper};
      if (!added) {
        const actuator::ParameterValue& before = declared.terms[t].linear[i];
        p.mean = before.value;
        p.scale = actuator::PriorSpread(before);
        p.precision = p.scale > 0.0 ? 1.0 : 0.0;
      }
      if (!(p.scale > 0.0)) p.scale = kScale * std::abs(p.mean);
      if (!(p.scale > 0.0)) {
        p.scale =
            kScale * trace::ExpectedSize(info.linear[i], recordings.machine(), model.constants);
      }
      if (!(p.scale > 0.0) || !std::isfinite(p.scale)) p.scale = kScale;
      out.push_back(p);
    }
    for (std::size_t i = 0; added && i < term.nonlinear.size(); ++i) {
      const double value = term.nonlinear[i].value;
      if (term.nonlinear[i].fixed || value == 0.0) continue;
      out.push_back({number, static_cast<int>(i), true, value, kScale * std::abs(value), 1.0,
                     info.nonlinear[i].lower, info.nonlinear[i].upper});
    }
  }
  return out;
}

Fit FitBySimulation(const Recordings& recordings, const actuator::JointModel& model,
                    const actuator::JointModel& declared) {
  return FitUnknowns(recordings, model, FreeParameters(recordings, model, declared));
}

Fit FitStart(const Recordings& recordings, const actuator::JointModel& model) {
  return FitUnknowns(recordings, model, {});
}

}  // namespace sinew::shooting
