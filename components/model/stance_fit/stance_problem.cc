#include "components/model/stance_fit/stance_problem.h"

#include <algorithm>
#include <cmath>

#include "components/model/trace/candidates.h"
#include "components/model/trace/set_search.h"
#include "components/model/trace/used_rows.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::stance_fit {

namespace {

using trace::Columns;
using trace::Hypothesis;

// Friction that a joint may have and its model may lack.
constexpr const char* kFriction[] = {"coulomb",
                                     "viscous",
                                     "direction_dependent_coulomb",
                                     "direction_dependent_viscous",
                                     "quadratic_viscous",
                                     "load_dependent_friction",
                                     "stribeck"};
constexpr const char* kTorqueConstant = "torque_constant_gain";
// Polynomials of a free curve over a joint's angle or velocity, the constant one first.
constexpr int kCurveOrders = 6;
// Blocks of the intervals: so long that what plain least squares leaves is not correlated across
// them; fewer would widen Student's t.
constexpr std::size_t kLongBlocks = 10;

class Builder {
 public:
  Builder(const StanceModel& model, const StanceLayout& layout,
          const std::vector<StanceRows>& recordings, const Tolerances& tolerances)
      : model_(model), layout_(layout), recordings_(recordings), tolerances_(tolerances) {
    for (const StanceRows& rows : recordings) {
      samples_ += rows.size();
      stacked_ += rows.stacked();
    }
    out_.channels = layout.channels();
  }

  Regression Build() {
    out_.bank.target =
        Stacked([](const StanceRows& rows) -> Eigen::MatrixXd { return rows.target; });
    bodies_ = Stacked([](const StanceRows& rows) { return rows.bodies; });
    AddDeclared();
    AddPayloads();
    for (std::size_t j = 0; j < layout_.moves.size(); ++j) {
      if (layout_.moves[j]) AddJoint(j);
    }
    AddFeet();
    AddTimes();
    out_.bank.declared = Joined(declared_);
    out_.bank.columns = Joined(columns_);
    const auto count = static_cast<Eigen::Index>(declared_.size());
    out_.bank.prior.mean = Eigen::VectorXd::Zero(count);
    out_.bank.prior.precision.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double spread = spreads_[static_cast<std::size_t>(i)];
      out_.bank.prior.precision[i] = spread > 0.0 ? 1.0 / (spread * spread) : 0.0;
    }
    out_.bank.spread = Eigen::Map<const Eigen::VectorXd>(
        column_spreads_.data(), static_cast<Eigen::Index>(column_spreads_.size()));
    out_.bank.parameters = count;
    return std::move(out_);
  }

 private:
  template <class Function>
  Eigen::MatrixXd Stacked(Function of) const {
    Eigen::MatrixXd out;
    Eigen::Index at = 0;
    for (const StanceRows& rows : recordings_) {
      const Eigen::MatrixXd part = of(rows);
      if (out.size() == 0) out.resize(stacked_, part.cols());
      out.middleRows(at, part.rows()) = part;
      at += part.rows();
    }
    return out;
  }

  Eigen::MatrixXd Joined(const std::vector<Eigen::VectorXd>& columns) const {
    Eigen::MatrixXd out(stacked_, static_cast<Eigen::Index>(columns.size()));
    for (std::size_t c = 0; c < columns.size(); ++c)
      out.col(static_cast<Eigen::Index>(c)) = columns[c];
    return out;
  }

  // An effect's columns at a joint, negative as in target = ... - phi theta.
  Eigen::MatrixXd AtJoint(std::size_t joint, const effects::Effect& effect,
                          const std::vector<double>& psi) const {
    const auto count = static_cast<Eigen::Index>(effect.info().linear.size());
    return Stacked([&](const StanceRows& rows) {
      Eigen::MatrixXd phi(rows.size(), count);
      std::vector<double> one(static_cast<std::size_t>(count));
      for (Eigen::Index i = 0; i < rows.size(); ++i) {
        effect.Regressors(rows.joints[joint][static_cast<std::size_t>(i)], psi, {}, one);
        for (Eigen::Index c = 0; c < count; ++c) phi(i, c) = one[static_cast<std::size_t>(c)];
      }
      Eigen::MatrixXd part(rows.stacked(), count);
      for (Eigen::Index c = 0; c < count; ++c) {
        part.col(c) = -rows.AtJoint(layout_, joint, phi.col(c));
      }
      return part;
    });
  }

  void Declare(const Eigen::VectorXd& column, double spread, Regression::Parameter parameter = {}) {
    declared_.push_back(column);
    spreads_.push_back(spread);
    out_.parameters.push_back(parameter);
  }

  void AddDeclared() {
    const std::vector<actuator::JointModel>& joints = model_.robot().joints;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (!layout_.moves[j]) continue;
      for (std::size_t t = 0; t < joints[j].terms.size(); ++t) {
        const actuator::Term& term = joints[j].terms[t];
        // The bodies are the chain's.
        if (!joints[j].Counts(term) || term.effect->info().name == "rigid_body") continue;
        const bool drive = term.effect->info().role == effects::Role::kDrive;
        const Eigen::MatrixXd columns = AtJoint(j, *term.effect, actuator::NonlinearValues(term));
        for (std::size_t i = 0; i < term.linear.size(); ++i) {
          const Eigen::VectorXd column = columns.col(static_cast<Eigen::Index>(i));
          // The drive's torque is part of the target already.
          if (!drive) out_.bank.target -= term.linear[i].value * column;
          if (term.linear[i].fixed) continue;
          Declare(column, actuator::PriorSpread(term.linear[i]),
                  {static_cast<int>(j), static_cast<int>(t), static_cast<int>(i)});
        }
      }
    }
    for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
      const double mass = model_.MassOf(layout_.groups[g]);
      for (int c = 0; c < kPayloadColumns; ++c) {
        const double spread = c == 0 ? tolerances_.mass_share * mass : tolerances_.com_m * mass;
        if (spread > 0.0) Declare(Body(g, c), spread);
      }
    }
    if (tolerances_.force_share > 0.0) {
      Declare(Stacked([](const StanceRows& rows) { return rows.forces; }).col(0),
              tolerances_.force_share);
    }
    if (tolerances_.tilt_rad > 0.0) {
      const Eigen::MatrixXd tilt = Stacked([](const StanceRows& rows) { return rows.tilt; });
      for (Eigen::Index axis = 0; axis < tilt.cols(); ++axis) {
        Declare(tilt.col(axis), tolerances_.tilt_rad);
      }
    }
  }

  Eigen::VectorXd Body(std::size_t group, int column) const {
    return bodies_.col(kPayloadColumns * static_cast<Eigen::Index>(group) + column);
  }

  Columns AddColumn(const Eigen::VectorXd& column, double spread) {
    columns_.push_back(column);
    column_spreads_.push_back(spread);
    return {static_cast<Eigen::Index>(columns_.size()) - 1};
  }

  Hypothesis Named(const std::string& name, const std::string& effect,
                   const std::string& variable) {
    Hypothesis h;
    h.name = name;
    h.variable = variable;
    if (!effect.empty()) h.effect = effects::MakeEffect(effect, {});
    h.family = ++families_;
    return h;
  }

  void Finish(Hypothesis h, const Subject& subject, double shapes) {
    h.charge = trace::kChargePerShape * shapes;
    out_.bank.hypotheses.push_back(std::move(h));
    out_.subjects.push_back(subject);
  }

  // Mass at the middle of the group, then first moments about it along the axes that show.
  void AddPayloads() {
    const double mass = trace::kPlausibleShare * model_.mass_kg();
    for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
      const RigidGroup& group = layout_.groups[g];
      const Eigen::MatrixXd body =
          bodies_.middleCols(kPayloadColumns * static_cast<Eigen::Index>(g), kPayloadColumns);
      Hypothesis h = Named("payload of " + group.name, "payload", "");
      const auto add = [&](const Eigen::VectorXd& column, double largest, double lower) {
        h.columns.push_back(AddColumn(column, largest).front());
        h.lower.push_back(lower);
        h.upper.push_back(2.0 * largest);
      };
      add(body.col(0) + body.rightCols<3>() * group.center_m, mass, 0.0);
      const double moment = mass * group.size_m;
      for (int axis = 0; axis < group.excited; ++axis) {
        add(body.rightCols<3>() * group.axes.col(axis), moment, -2.0 * moment);
      }
      h.settings.push_back({{}, h.columns});
      Finish(std::move(h), {Subject::Kind::kPayload, g}, 0.0);
    }
  }

  void AddJoint(std::size_t j) {
    const actuator::JointModel& joint = model_.robot().joints[j];
    double power = 0.0;
    double peak = 0.0;
    for (const StanceRows& rows : recordings_) {
      power += rows.drive.col(static_cast<Eigen::Index>(j)).squaredNorm();
      peak = std::max(peak, rows.drive.col(static_cast<Eigen::Index>(j)).cwiseAbs().maxCoeff());
    }
    const double rms = std::sqrt(power / std::max(1.0, static_cast<double>(samples_)));
    for (const char* name : kFriction) AddEffect(j, joint, name, rms, peak);
    AddEffect(j, joint, kTorqueConstant, rms, peak);
    AddCurve(j, joint.name + ".position_rad", rms,
             [](const effects::JointSample& x) { return x.position_rad; });
    AddCurve(j, joint.name + ".velocity_rad_s", rms,
             [](const effects::JointSample& x) { return x.velocity_rad_s; });
  }

  void AddEffect(std::size_t j, const actuator::JointModel& joint, const std::string& name,
                 double rms, double peak) {
    const std::shared_ptr<const effects::Effect> effect =
        effects::MakeEffect(name, joint.constants);
    // More or less of a declared term than its tolerance allows; without a tolerance the refit
    // takes it all.
    const int known = effect->info().nonlinear.empty() ? joint.Find(name, joint.balance) : -1;
    const actuator::Term* declared =
        known >= 0 ? &joint.terms[static_cast<std::size_t>(known)] : nullptr;
    if (declared != nullptr &&
        std::any_of(declared->linear.begin(), declared->linear.end(), [](const auto& value) {
          return !value.fixed && !(actuator::PriorSpread(value) > 0.0);
        })) {
      return;
    }
    // A declared drive factor that is refitted is this one.
    const bool stated =
        name == kTorqueConstant &&
        std::any_of(joint.terms.begin(), joint.terms.end(), [](const auto& term) {
          return term.effect->info().role == effects::Role::kDrive && !term.linear.front().fixed;
        });
    if (stated) return;
    const std::vector<std::vector<double>> grid = trace::GridOf(effect->info());
    const int family = ++families_;
    for (const std::vector<double>& psi : grid) {
      const Eigen::MatrixXd columns = AtJoint(j, *effect, psi);
      Hypothesis h = Named(name + " of " + joint.name, "", effect->info().variable);
      h.effect = effect;
      h.family = family;
      for (Eigen::Index c = 0; c < columns.cols(); ++c) {
        double largest = 0.0, squares = 0.0;
        for (const StanceRows& rows : recordings_) {
          std::vector<double> phi(effect->info().linear.size());
          for (const effects::JointSample& x : rows.joints[j]) {
            effect->Regressors(x, psi, {}, phi);
            const double value = std::abs(phi[static_cast<std::size_t>(c)]);
            largest = std::max(largest, value);
            squares += value * value;
          }
        }
        const double size = std::sqrt(squares / static_cast<double>(samples_));
        // A column of zeros (a Stribeck velocity that no row is slow enough for) takes part without
        // any size: every recording has the same columns.
        const double spread = size > 0.0 ? trace::kPlausibleShare * rms / size : 1.0;
        h.columns.push_back(AddColumn(columns.col(c), spread).front());
        // Nothing is stronger than what the drive was seen to do.
        const effects::ParameterInfo& info = effect->info().linear[static_cast<std::size_t>(c)];
        const double most = largest > 0.0 ? peak / largest : 0.0;
        const double less =
            declared != nullptr ? declared->linear[static_cast<std::size_t>(c)].value : 0.0;
        h.lower.push_back(info.lower < 0.0 ? -most : -less);
        h.upper.push_back(info.upper > 0.0 ? most : 0.0);
      }
      h.settings.push_back({psi, h.columns});
      Finish(std::move(h), {Subject::Kind::kJoint, j}, grid.size() > 1 ? 1.0 : 0.0);
    }
  }

  template <class Function>
  void AddCurve(std::size_t j, const std::string& variable, double rms, Function of) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const StanceRows& rows : recordings_) {
      for (const effects::JointSample& x : rows.joints[j]) {
        low = std::min(low, of(x));
        high = std::max(high, of(x));
      }
    }
    const double width = std::max(high - low, 1e-300);
    Hypothesis h = Named("curve over " + variable, "", variable);
    for (int order = 0; order < kCurveOrders; ++order) {
      const Eigen::MatrixXd column = Stacked([&](const StanceRows& rows) -> Eigen::MatrixXd {
        Eigen::VectorXd torque(rows.size());
        for (Eigen::Index i = 0; i < rows.size(); ++i) {
          const double x =
              2.0 * (of(rows.joints[j][static_cast<std::size_t>(i)]) - low) / width - 1.0;
          torque[i] = std::legendre(static_cast<unsigned>(order), x);
        }
        return rows.AtJoint(layout_, j, torque);
      });
      h.columns.push_back(AddColumn(column.col(0), trace::kPlausibleShare * rms).front());
    }
    Finish(std::move(h), {Subject::Kind::kCurve, j}, 0.0);
  }

  void AddFeet() {
    const Eigen::MatrixXd forces = Stacked([](const StanceRows& rows) { return rows.forces; });
    Hypothesis h = Named("load_cell_gain of the feet", "load_cell_gain", "load_force_N");
    h.columns = AddColumn(forces.col(0), trace::kPlausibleShare);
    h.lower = {-trace::kPlausibleShare};
    h.upper = {trace::kPlausibleShare};
    h.settings.push_back({{}, h.columns});
    Finish(std::move(h), {Subject::Kind::kForces, 0}, 0.0);
  }

  // Time, stretches and blocks of every recording; none crosses from one to the next.
  void AddTimes() {
    out_.time_s.resize(samples_);
    Eigen::Index at = 0;
    const auto of_tests = std::max<Eigen::Index>(
        trace::kFewestRowsPerBlock, (samples_ + trace::kMostBlocks - 1) / trace::kMostBlocks);
    const Eigen::Index of_intervals = std::max<Eigen::Index>(
        trace::kFewestRowsPerBlock, (samples_ + static_cast<Eigen::Index>(kLongBlocks) - 1) /
                                        static_cast<Eigen::Index>(kLongBlocks));
    for (std::size_t r = 0; r < recordings_.size(); ++r) {
      const StanceRows& rows = recordings_[r];
      if (rows.size() == 0) continue;
      const double first = rows.time_s[0], last = rows.time_s[rows.size() - 1];
      for (const trace::Stretch& stretch : rows.stretches) {
        out_.stretches.push_back({at + stretch.first, stretch.count});
      }
      AddBlocks(at, rows.size(), of_tests, &out_.blocks);
      AddBlocks(at, rows.size(), of_intervals, &out_.long_blocks);
      for (Eigen::Index i = 0; i < rows.size(); ++i, ++at) {
        out_.time_s[at] =
            last > first ? 2.0 * (rows.time_s[i] - first) / (last - first) - 1.0 : 0.0;
        out_.recording.push_back(r);
      }
    }
  }

  // Adds the blocks of one recording, as even as they come.
  void AddBlocks(Eigen::Index first, Eigen::Index count, Eigen::Index length,
                 std::vector<identify::Block>* blocks) const {
    const Eigen::Index parts = std::max<Eigen::Index>(1, count / length);
    for (Eigen::Index p = 0; p < parts; ++p) {
      identify::Block block;
      for (Eigen::Index i = first + p * count / parts; i < first + (p + 1) * count / parts; ++i) {
        for (Eigen::Index c = 0; c < out_.channels; ++c) block.push_back(i * out_.channels + c);
      }
      blocks->push_back(std::move(block));
    }
  }

  const StanceModel& model_;
  const StanceLayout& layout_;
  const std::vector<StanceRows>& recordings_;
  const Tolerances& tolerances_;
  Eigen::Index samples_ = 0, stacked_ = 0;
  Eigen::MatrixXd bodies_;
  std::vector<Eigen::VectorXd> declared_, columns_;
  std::vector<double> spreads_, column_spreads_;
  int families_ = 0;
  Regression out_;
};

Eigen::VectorXd Channel(const Eigen::Ref<const Eigen::VectorXd>& stacked, Eigen::Index channel,
                        Eigen::Index channels) {
  return stacked(Eigen::seqN(channel, stacked.size() / channels, channels));
}

}  // namespace

Regression MakeRegression(const StanceModel& model, const StanceLayout& layout,
                          const std::vector<StanceRows>& recordings, const Tolerances& tolerances) {
  return Builder(model, layout, recordings, tolerances).Build();
}

ChannelNoise NoiseOf(const Regression& regression,
                     const Eigen::Ref<const Eigen::VectorXd>& residual, int longest_order) {
  ChannelNoise out;
  for (Eigen::Index c = 0; c < regression.channels; ++c) {
    out.emplace_back(Channel(residual, c, regression.channels), regression.stretches,
                     longest_order);
  }
  return out;
}

Eigen::MatrixXd Whiten(const Regression& regression, const ChannelNoise& noise,
                       const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  Eigen::MatrixXd out(columns.rows(), columns.cols());
  const Eigen::Index m = regression.channels, samples = columns.rows() / m;
  for (Eigen::Index c = 0; c < m; ++c) {
    const auto rows = Eigen::seqN(c, samples, m);
    const Eigen::MatrixXd of_channel = columns(rows, Eigen::all);
    out(rows, Eigen::all) =
        noise[static_cast<std::size_t>(c)].Whiten(of_channel, regression.stretches);
  }
  return out;
}

trace::Problem MakeProblem(const Regression& regression, const ChannelNoise& noise) {
  const trace::Bank& bank = regression.bank;
  Eigen::MatrixXd X = Whiten(regression, noise, bank.declared);
  Eigen::MatrixXd Z = Whiten(regression, noise, bank.columns);
  Eigen::VectorXd y = Whiten(regression, noise, bank.target);
  const Eigen::VectorXd precision = bank.spread.array().square().inverse();
  trace::Evidence evidence(X, bank.prior, Z, precision, y);
  trace::Problem out{bank, std::move(X),        std::move(Z), std::move(y),
                     1.0,  std::move(evidence), 0.0,          bank.prior.precision};
  out.variance = out.LeftPlain(bank.target).squaredNorm();
  return out;
}

ChannelNoise EstimateNoise(const Regression& regression, int longest_order) {
  // White at first, of the size of what is left; coloured once the leading effects are out of it.
  constexpr int kPasses = 3;
  ChannelNoise noise = NoiseOf(regression, regression.bank.target, 0);
  for (int pass = 1; pass <= kPasses; ++pass) {
    const trace::Problem problem = MakeProblem(regression, noise);
    const trace::EffectSet set =
        trace::SearchSets(problem.choices(), trace::kLargestSet).best.back();
    const Eigen::VectorXd rest =
        regression.bank.target - problem.Part(set) -
        regression.bank.declared * problem.evidence.Declared(set.columns, set.c);
    noise = NoiseOf(regression, rest, pass < kPasses ? 0 : longest_order);
  }
  return noise;
}

}  // namespace sinew::stance_fit
