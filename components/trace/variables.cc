#include "components/trace/variables.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <utility>

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
constexpr int kLevels = 20;       // of a recording
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
  std::function<Eigen::MatrixXd(std::size_t)> columns;  // of a setting

  // The setting with the least error on everything.
  std::size_t Best() const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < settings.size(); ++k) {
      const double error = settings[k].SquaredError(settings[k].Coefficients());
      if (error >= least) continue;
      least = error;
      best = k;
    }
    return best;
  }
};

}  // namespace

Eigen::MatrixXd DriftColumns(const identify::Design& design) {
  if (!design.rows().window.empty()) return {};
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  Eigen::MatrixXd out = Curve(design, kTime, used);
  const Eigen::Index curves = out.cols() / 2;
  const Eigen::VectorXd always = design.Column([](const JointSample&) { return 1.0; });
  const Eigen::VectorXd angle = design.Column(Angle);
  for (Eigen::Index c = 0; c < curves; ++c) {
    double mean = 0.0;
    for (const Eigen::Index i : used) mean += out(i, c) / static_cast<double>(used.size());
    out.col(c) -= mean * always;
    out.col(curves + c) -= mean * angle;
  }
  return out;
}

double LevelShare(const identify::Design& design,
                  const Eigen::Ref<const Eigen::VectorXd>& residual) {
  struct Level {
    double sum = 0.0, rows = 0.0;
  };
  const identify::Rows& rows = design.rows();
  const std::vector<Eigen::Index> used = rows.UsedRows();
  const auto run_of = [&](Eigen::Index i) { return rows.run[static_cast<std::size_t>(i)]; };
  std::map<int, std::pair<double, double>> span;  // first and last instant
  for (const Eigen::Index i : used) {
    auto [at, fresh] = span.try_emplace(run_of(i), rows.time_s[i], rows.time_s[i]);
    at->second.first = std::min(at->second.first, rows.time_s[i]);
    at->second.second = std::max(at->second.second, rows.time_s[i]);
  }
  std::map<std::pair<int, int>, Level> levels;
  double power = 0.0;
  for (const Eigen::Index i : used) {
    const auto [first, last] = span.at(run_of(i));
    const double part = last > first ? (rows.time_s[i] - first) / (last - first) : 0.0;
    Level& level = levels[{run_of(i), std::min(kLevels - 1, static_cast<int>(kLevels * part))}];
    level.sum += residual[i];
    level.rows += 1.0;
    power += residual[i] * residual[i];
  }
  double carried = 0.0;
  for (const auto& [where, level] : levels) carried += level.sum * level.sum / level.rows;
  return power > 0.0 ? carried / power : 0.0;
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
  std::vector<Setting> base_setting = {Setting(blocks, base, none, target, folds)};
  const Eigen::VectorXd base_errors = LeftOutErrors(base_setting, ones, folds);

  std::vector<Entry> entries;
  const auto measured = [&](const std::string& field) {
    return design.states().measured.count(field) != 0;
  };
  for (const Variable& variable : kVariables) {
    if (!measured(variable.name)) continue;
    if (design.NoiseShare(variable.get) > identify::kMostNoise) continue;
    Entry entry;
    entry.score.variable = variable.name;
    entry.columns = [&design, &variable, &used](std::size_t) {
      return Curve(design, variable, used);
    };
    const Eigen::MatrixXd columns = entry.columns(0);
    if (columns.cols() == 0 || !columns.allFinite()) continue;
    entry.settings.emplace_back(blocks, base, columns, target, folds);
    entries.push_back(std::move(entry));
  }
  const auto add_orders = [&](const char* name, Getter get, int last, int harmonics) {
    if (!measured(name)) return;
    Entry entry;
    entry.score.variable = name;
    entry.columns = [&design, get, harmonics](std::size_t k) {
      const auto order = static_cast<int>(k) + 1;
      Eigen::MatrixXd columns(design.rows().size(), 2 * harmonics);
      for (int h = 0; h < harmonics; ++h) {
        const double times = order * (h + 1);
        columns.col(2 * h) =
            design.Column([&](const JointSample& x) { return std::sin(times * get(x)); });
        columns.col(2 * h + 1) =
            design.Column([&](const JointSample& x) { return std::cos(times * get(x)); });
      }
      return columns;
    };
    for (int order = 1; order <= last; ++order) {
      entry.settings.emplace_back(blocks, base, entry.columns(entry.orders.size()), target, folds);
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
    const std::size_t best = entry.Best();
    if (!entry.orders.empty()) entry.score.order_per_turn = entry.orders[best];
    const Setting& setting = entry.settings[best];
    entry.score.size_in_errors =
        SizeInErrors(Joined(setting.blocks(), setting.Coefficients(), base.cols()));
    out.scores.push_back(entry.score);
  }
  // A clear curve would be its own noise: it goes first, as in the placebo of candidates.
  const auto clearest = std::max_element(
      entries.begin(), entries.end(),
      [](const Entry& a, const Entry& b) { return a.score.share < b.score.share; });
  if (clearest != entries.end() && clearest->score.share > kClearGain) {
    const std::size_t k = clearest->Best();
    const Eigen::VectorXd b = clearest->settings[k].Coefficients();
    const Eigen::VectorXd noise =
        target - base * b.head(base.cols()) - clearest->columns(k) * b.tail(b.size() - base.cols());
    base_setting = {Setting(blocks, base, none, noise, folds)};
    for (Entry& entry : entries) {
      for (std::size_t i = 0; i < entry.settings.size(); ++i) {
        entry.settings[i] = entry.settings[i].Retarget(blocks, base, entry.columns(i), noise);
      }
    }
  }
  std::mt19937_64 random(seed);
  std::vector<double> best_false;
  for (int round = 0; round < placebo_rounds; ++round) {
    Eigen::VectorXd signs(ones.size());
    for (double& sign : signs) sign = (random() & 1) != 0 ? 1.0 : -1.0;
    const Eigen::VectorXd errors = LeftOutErrors(base_setting, signs, folds);
    double best = 0.0;
    for (const Entry& entry : entries) {
      best =
          std::max(best, (errors - LeftOutErrors(entry.settings, signs, folds)).sum() / base_sum);
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
