#include "components/trace/variables.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "components/identify/statistics.h"

namespace sinew::trace {

namespace {

using effects::JointSample;
using Getter = double (*)(const JointSample&);

struct Variable {
  const char* name;
  Getter get;
  // What the curve may also be multiplied by: friction follows the direction, a base that moves the
  // angle.
  Getter times = nullptr;
};

double Direction(const JointSample& x) {
  return static_cast<double>(x.velocity_rad_s > 0.0) - static_cast<double>(x.velocity_rad_s < 0.0);
}
double Angle(const JointSample& x) { return x.position_rad; }

constexpr Variable kTime = {"time_s", [](const JointSample& x) { return x.time_s; }, Angle};
constexpr Variable kVariables[] = {
    {"position_rad", [](const JointSample& x) { return x.position_rad; }, Direction},
    {"velocity_rad_s", [](const JointSample& x) { return x.velocity_rad_s; }},
    {"acceleration_rad_s2", [](const JointSample& x) { return x.acceleration_rad_s2; }},
    {"jerk_rad_s3", [](const JointSample& x) { return x.jerk_rad_s3; }},
    {"drive_input", [](const JointSample& x) { return x.drive_input; }},
    {"drive_rate", [](const JointSample& x) { return x.drive_rate; }},
    {"pressure_bar", [](const JointSample& x) { return x.pressure_bar; }, Direction},
    {"pressure_rate_bar_s", [](const JointSample& x) { return x.pressure_rate_bar_s; }},
    {"load_force_N", [](const JointSample& x) { return x.load_force_N; }, Direction},
    {"tooth_torque_Nm", [](const JointSample& x) { return x.tooth_torque_Nm; }},
    {"tooth_side", [](const JointSample& x) { return x.tooth_side; }},
    {"temperature_degC", [](const JointSample& x) { return x.temperature_degC; }, Direction},
    kTime,
};

constexpr int kKnots = 8;
constexpr int kWheelOrders = 20;  // turns of a wheel per turn of the output
constexpr int kToothHarmonics = 8;

// Hat functions on quantiles of the variable over the used rows, and the same times another signal.
Eigen::MatrixXd Curve(const identify::Design& design, const Variable& variable,
                      const std::vector<Eigen::Index>& used) {
  const Getter get = variable.get;
  const Eigen::VectorXd values = design.Variable(get);
  std::vector<double> sorted;
  for (const Eigen::Index i : used) sorted.push_back(values[i]);
  std::vector<double> knots;
  for (int k = 0; k < kKnots; ++k) {
    const double knot = identify::Quantile(sorted, static_cast<double>(k) / (kKnots - 1));
    if (knots.empty() || knot > knots.back() + 1e-9 * (1.0 + std::abs(knot))) knots.push_back(knot);
  }
  if (knots.size() < 3) return {};
  const auto hat = [&](const JointSample& x, std::size_t k) {
    const double v = std::clamp(get(x), knots.front(), knots.back());
    if (k > 0 && v < knots[k]) {
      return std::max(0.0, (v - knots[k - 1]) / (knots[k] - knots[k - 1]));
    }
    if (k + 1 < knots.size() && v > knots[k]) {
      return std::max(0.0, (knots[k + 1] - v) / (knots[k + 1] - knots[k]));
    }
    return v == knots[k] ? 1.0 : 0.0;
  };
  const std::size_t count = knots.size() * (variable.times != nullptr ? 2 : 1);
  Eigen::MatrixXd out(design.rows().size(), static_cast<Eigen::Index>(count));
  for (std::size_t c = 0; c < count; ++c) {
    const bool times = c >= knots.size();
    out.col(static_cast<Eigen::Index>(c)) = design.Column([&](const JointSample& x) {
      return hat(x, c % knots.size()) * (times ? variable.times(x) : 1.0);
    });
  }
  return out;
}

struct Entry {
  VariableScore score;
  std::vector<Setting> settings;
  std::vector<double> orders;
};

}  // namespace

Eigen::MatrixXd DriftColumns(const identify::Design& design) {
  return Curve(design, kTime, design.rows().UsedRows());
}

VariableScan ScanVariables(const identify::Design& design,
                           const std::vector<identify::Block>& blocks,
                           const Eigen::Ref<const Eigen::MatrixXd>& base,
                           const Eigen::Ref<const Eigen::VectorXd>& target, int folds,
                           int placebo_rounds, double placebo_quantile, std::uint64_t seed) {
  VariableScan out;
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  const Eigen::MatrixXd none(base.rows(), 0);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(blocks.size()));
  const std::vector<Setting> base_setting = {Setting(blocks, base, none, target, folds)};
  const Eigen::VectorXd base_errors = LeftOutErrors(base_setting, ones, folds);

  std::vector<Entry> entries;
  const auto measured = [&](const std::string& field) {
    return design.states().measured.count(field) != 0;
  };
  for (const Variable& variable : kVariables) {
    if (!measured(variable.name)) continue;
    if (design.NoiseShare(variable.get) > identify::kMostNoise) continue;
    const Eigen::MatrixXd columns = Curve(design, variable, used);
    if (columns.cols() == 0 || !columns.allFinite()) continue;
    Entry entry;
    entry.score.variable = variable.name;
    entry.settings.emplace_back(blocks, base, columns, target, folds);
    entries.push_back(std::move(entry));
  }
  const auto add_orders = [&](const char* name, Getter get, int last, int harmonics) {
    if (!measured(name)) return;
    Entry entry;
    entry.score.variable = name;
    for (int order = 1; order <= last; ++order) {
      Eigen::MatrixXd columns(design.rows().size(), 2 * harmonics);
      for (int h = 0; h < harmonics; ++h) {
        const double times = order * (h + 1);
        columns.col(2 * h) =
            design.Column([&](const JointSample& x) { return std::sin(times * get(x)); });
        columns.col(2 * h + 1) =
            design.Column([&](const JointSample& x) { return std::cos(times * get(x)); });
      }
      entry.settings.emplace_back(blocks, base, columns, target, folds);
      entry.orders.push_back(order);
    }
    entries.push_back(std::move(entry));
  };
  add_orders(
      "motor_position_rad", [](const JointSample& x) { return x.motor_position_rad; }, 42, 1);
  // A fault of one tooth comes once per turn of its wheel, and is short.
  add_orders("position_rad", Angle, kWheelOrders, kToothHarmonics);

  const double base_sum = base_errors.sum();
  if (!(base_sum > 0.0)) return out;
  for (Entry& entry : entries) {
    const Eigen::VectorXd gains = base_errors - LeftOutErrors(entry.settings, ones, folds);
    entry.score.gain = GainOf(gains);
    entry.score.share = entry.score.gain.sum / base_sum;
    double rows = 0.0;
    for (const identify::Block& block : blocks) rows += static_cast<double>(block.size());
    entry.score.rms = std::sqrt(std::max(0.0, entry.score.gain.sum / rows));
    if (!entry.orders.empty()) {
      double least = 0.0;
      for (std::size_t k = 0; k < entry.settings.size(); ++k) {
        double error = 0.0;
        const Eigen::VectorXd b = entry.settings[k].Coefficients();
        for (const identify::Moments& sums : entry.settings[k].blocks()) {
          error += sums.SquaredError(b);
        }
        if (k == 0 || error < least) {
          least = error;
          entry.score.order_per_turn = entry.orders[k];
        }
      }
    }
    out.scores.push_back(entry.score);
  }
  std::mt19937_64 random(seed);
  std::vector<double> best_false;
  for (int round = 0; round < placebo_rounds; ++round) {
    Eigen::VectorXd signs(ones.size());
    for (double& sign : signs) sign = (random() & 1) != 0 ? 1.0 : -1.0;
    const Eigen::VectorXd errors = LeftOutErrors(base_setting, signs, folds);
    double best = 0.0;
    for (const Entry& entry : entries) {
      best = std::max(best,
                      (errors - LeftOutErrors(entry.settings, signs, folds)).sum() / errors.sum());
    }
    best_false.push_back(best);
  }
  out.placebo_99 = identify::Quantile(best_false, placebo_quantile);
  std::stable_sort(
      out.scores.begin(), out.scores.end(),
      [](const VariableScore& a, const VariableScore& b) { return a.share > b.share; });
  return out;
}

}  // namespace sinew::trace
