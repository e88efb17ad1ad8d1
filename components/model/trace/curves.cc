#include "components/model/trace/curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "components/model/trace/candidates.h"

namespace sinew::trace {

namespace {

using effects::JointSample;
using Getter = double (*)(const JointSample&);

double One(const JointSample&) { return 1.0; }
double Direction(const JointSample& x) {
  return static_cast<double>(x.velocity_rad_s > 0.0) - static_cast<double>(x.velocity_rad_s < 0.0);
}
double Position(const JointSample& x) { return x.position_rad; }
double Velocity(const JointSample& x) { return x.velocity_rad_s; }
double CosineOfAngle(const JointSample& x) { return std::cos(x.position_rad); }
double SineOfAngle(const JointSample& x) { return std::sin(x.position_rad); }

struct Variable {
  const char* name;
  Getter get;
  int knots;
  Getter times = One;
  const char* of = "";  // words for `times`
};

constexpr const char* kByDirection = " times the direction";

// Knots: what a mechanism may need to show its shape. Few where physics is smooth, many where one
// tooth or one cable tie acts in a small part of the range.
constexpr Variable kVariables[] = {
    {"position_rad", Position, 12},
    {"position_rad", Position, 12, Direction, kByDirection},
    {"position_rad", Position, 40},
    {"velocity_rad_s", Velocity, 12},
    {"acceleration_rad_s2", [](const JointSample& x) { return x.acceleration_rad_s2; }, 8},
    {"drive_input", [](const JointSample& x) { return x.drive_input; }, 8},
    {"drive_input", [](const JointSample& x) { return x.drive_input; }, 8, Direction, kByDirection},
    {"pressure_bar", [](const JointSample& x) { return x.pressure_bar; }, 6},
    {"pressure_bar", [](const JointSample& x) { return x.pressure_bar; }, 6, Direction,
     kByDirection},
    {"pressure_bar", [](const JointSample& x) { return x.pressure_bar; }, 6, Position,
     " times the angle"},
    {"load_force_N", [](const JointSample& x) { return x.load_force_N; }, 6},
    {"load_force_N", [](const JointSample& x) { return x.load_force_N; }, 6, Direction,
     kByDirection},
    {"temperature_degC", [](const JointSample& x) { return x.temperature_degC; }, 5, Direction,
     kByDirection},
    {"temperature_degC", [](const JointSample& x) { return x.temperature_degC; }, 5, Velocity,
     " times the velocity"},
    {"tooth_torque_Nm", [](const JointSample& x) { return x.tooth_torque_Nm; }, 8},
};

// Values of hat function k at v; knots rise.
double Hat(const std::vector<double>& knots, std::size_t k, double value) {
  const double v = std::clamp(value, knots.front(), knots.back());
  if (k > 0 && v < knots[k]) return std::max(0.0, (v - knots[k - 1]) / (knots[k] - knots[k - 1]));
  if (k + 1 < knots.size() && v > knots[k]) {
    return std::max(0.0, (knots[k + 1] - v) / (knots[k + 1] - knots[k]));
  }
  return v == knots[k] ? 1.0 : 0.0;
}

std::vector<double> Knots(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& used,
                          int count) {
  std::vector<double> sorted;
  sorted.reserve(used.size());
  for (const Eigen::Index i : used) sorted.push_back(values[i]);
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> knots;
  const double span = sorted.empty() ? 0.0 : sorted.back() - sorted.front();
  for (int k = 0; k < count && !sorted.empty(); ++k) {
    const auto at = static_cast<std::size_t>(
        std::lround(static_cast<double>(k) / (count - 1) * static_cast<double>(sorted.size() - 1)));
    if (knots.empty() || sorted[at] > knots.back() + 1e-3 * span / count)
      knots.push_back(sorted[at]);
  }
  return knots;
}

Curve Over(const identify::Design& design, const Variable& variable,
           const std::vector<Eigen::Index>& used) {
  Curve out{variable.name, std::string("curve over ") + variable.name + variable.of, {}};
  const std::vector<double> knots = Knots(design.Variable(variable.get), used, variable.knots);
  if (knots.size() < 3) return out;
  out.columns.resize(design.rows().size(), static_cast<Eigen::Index>(knots.size()));
  for (std::size_t k = 0; k < knots.size(); ++k) {
    out.columns.col(static_cast<Eigen::Index>(k)) = design.Column(
        [&](const JointSample& x) { return Hat(knots, k, variable.get(x)) * variable.times(x); });
  }
  return out;
}

// One turn of the motor: what comes back with every turn, whatever its shape.
Curve OverMotorTurn(const identify::Design& design) {
  constexpr int kParts = 24;
  Curve out{"motor_position_rad", "curve over one turn of the motor", {}};
  out.columns.resize(design.rows().size(), kParts);
  for (int k = 0; k < kParts; ++k) {
    out.columns.col(k) = design.Column([&](const JointSample& x) {
      const double turns = x.motor_position_rad / (2.0 * std::numbers::pi);
      const double at = kParts * (turns - std::floor(turns)) - k;
      const double apart = std::min(std::abs(at), kParts - std::abs(at));
      return std::max(0.0, 1.0 - apart);
    });
  }
  return out;
}

// Time in every recording: drifts, alone or of what `times` stands for.
Curve OverTime(const identify::Design& design, const Getter times, const std::string& of,
               const std::vector<Eigen::Index>& used) {
  constexpr int kParts = 6;
  Curve out{"time_s", "drift over time" + of, {}};
  const identify::Rows& rows = design.rows();
  std::set<int> runs;
  for (const Eigen::Index i : used) runs.insert(rows.run[static_cast<std::size_t>(i)]);
  std::vector<Eigen::VectorXd> columns;
  const Eigen::VectorXd factor = design.Variable(times);
  for (const int run : runs) {
    std::vector<Eigen::Index> of_run;
    for (const Eigen::Index i : used) {
      if (rows.run[static_cast<std::size_t>(i)] == run) of_run.push_back(i);
    }
    const std::vector<double> knots = Knots(rows.time_s, of_run, kParts);
    if (knots.size() < 3) continue;
    for (std::size_t k = 0; k < knots.size(); ++k) {
      Eigen::VectorXd column = Eigen::VectorXd::Zero(rows.size());
      for (Eigen::Index i = 0; i < rows.size(); ++i) {
        if (rows.run[static_cast<std::size_t>(i)] != run) continue;
        column[i] = Hat(knots, k, rows.time_s[i]) * factor[i];
      }
      columns.push_back(std::move(column));
    }
  }
  out.columns.resize(rows.size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    out.columns.col(static_cast<Eigen::Index>(c)) = columns[c];
  }
  return out;
}

// Is it the balance's measured side, or made of it? A second derivative of one of two encoders is
// mostly that encoder's noise.
bool IsOfTarget(std::string_view variable, const identify::Design& design,
                effects::Balance balance) {
  return (variable == "load_force_N" && design.states().locked) ||
         (variable == "acceleration_rad_s2" && balance == effects::Balance::kKinematic) ||
         (variable == "pressure_bar" && balance == effects::Balance::kGas);
}

}  // namespace

std::vector<Curve> FreeCurves(const identify::Design& design, effects::Balance balance) {
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  std::vector<Curve> out;
  const auto add = [&](Curve curve) {
    for (Eigen::Index c = 0; c < curve.columns.cols(); ++c) design.Centre(curve.columns.col(c));
    if (curve.columns.cols() > 0 && curve.columns.allFinite()) out.push_back(std::move(curve));
  };
  for (const Variable& variable : kVariables) {
    if (!design.states().measured.contains(variable.name) ||
        DiffersBetweenFewRecordings(design, variable.name)) {
      continue;
    }
    if (IsOfTarget(variable.name, design, balance)) continue;
    add(Over(design, variable, used));
  }
  if (design.states().measured.contains("motor_position_rad")) add(OverMotorTurn(design));
  // Every window of a chamber has a level of its own already, and no time runs between holds.
  if (balance == effects::Balance::kGas || design.held()) return out;
  add(OverTime(design, One, "", used));
  add(OverTime(design, Direction, kByDirection, used));
  add(OverTime(design, CosineOfAngle, " times the cosine of the angle", used));
  add(OverTime(design, SineOfAngle, " times the sine of the angle", used));
  return out;
}

}  // namespace sinew::trace
