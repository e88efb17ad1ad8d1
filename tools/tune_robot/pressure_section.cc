#include <algorithm>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tools/tune_robot/tune_section.h"

namespace sinew::tune {
namespace {

using report::PictureNumber;
using report::Short;

const std::vector<actuator::JointModel>& JointsOf(const PressureSweepConfig& config) {
  return config.elastic.robot.model.joints;
}

// The larger of the peaks of left_x and right_x is that of "x".
std::string WithoutSide(const std::string& joint) {
  for (const std::string side : {"left_", "right_"}) {
    if (joint.rfind(side, 0) == 0) return joint.substr(side.size());
  }
  return joint;
}

struct PeakGroup {
  std::string name;
  std::vector<std::size_t> joints;
};

std::vector<PeakGroup> PeakGroups(const PressureSweepConfig& config) {
  std::vector<PeakGroup> groups;
  for (std::size_t j = 0; j < JointsOf(config).size(); ++j) {
    const std::string name = WithoutSide(JointsOf(config)[j].name);
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&name](const PeakGroup& group) { return group.name == name; });
    if (found == groups.end()) {
      groups.push_back({name, {j}});
    } else {
      found->joints.push_back(j);
    }
  }
  return groups;
}

double PeakOf(const PeakGroup& group, const PressurePoint& point) {
  double peak_Nm = 0.0;
  for (const std::size_t j : group.joints) {
    peak_Nm = std::max(peak_Nm, point.trial.peak_torque_Nm[j]);
  }
  return peak_Nm;
}

std::string PressureName(const PressurePoint& point) {
  return point.pressure_bar ? Short(*point.pressure_bar) : std::string("rigid");
}

struct EnergySeries {
  const char* name;
  const char* colour;
  double (*of)(const performance::RobotPerformanceOutput&);
};
constexpr EnergySeries kEnergySeries[] = {
    {"positive work", report::kAfterColour, [](const auto& p) { return p.energies.positive_J; }},
    {"net work", report::kMeasuredColour, [](const auto& p) { return p.energies.net_J; }},
    {"electrical, drawn", report::kBeforeColour, [](const auto& p) { return p.drawn_J; }},
};

// A figure over the pressure; that of the rigid robot as a level line.
void AddLines(const std::vector<PressurePoint>& points, const std::string& name, const char* colour,
              const std::function<double(const PressurePoint&)>& figure,
              std::vector<report::Series>* out) {
  report::Series curve = {name, colour, {}, {}, "linespoints pt 7 ps 0.7 lw 2"};
  for (const PressurePoint& point : points) {
    if (!point.pressure_bar || !point.stands()) continue;
    curve.Add(*point.pressure_bar, figure(point));
  }
  if (points.front().stands() && !curve.x.empty()) {
    const double rigid = figure(points.front());
    out->push_back(
        {"", colour, {curve.x.front(), curve.x.back()}, {rigid, rigid}, "lines dt 2 lw 1.2"});
  }
  out->push_back(std::move(curve));
}

report::Picture EnergyPicture(const std::vector<PressurePoint>& points) {
  std::vector<report::Series> lines;
  for (const EnergySeries& series : kEnergySeries) {
    AddLines(
        points, series.name, series.colour,
        [&](const PressurePoint& point) { return series.of(point.trial.performance); }, &lines);
  }
  return report::Chart("Energies of the motion over the pressure",
                       "Points: SEA-PEA actuators. Lines: rigid actuators.", "pressure, bar", 324,
                       {{"energy, J", std::move(lines), "0:"}});
}

report::Picture PeakPicture(const PressureSweepConfig& config,
                            const std::vector<PressurePoint>& points) {
  const std::vector<std::size_t> pneumatic = PneumaticJoints(config.elastic.robot.model);
  std::vector<report::Series> lines;
  std::size_t number = 0;
  for (const PeakGroup& group : PeakGroups(config)) {
    if (std::find(pneumatic.begin(), pneumatic.end(), group.joints.front()) == pneumatic.end()) {
      continue;
    }
    AddLines(
        points, group.name, report::kSeriesColours[number++ % std::size(report::kSeriesColours)],
        [&](const PressurePoint& point) { return PeakOf(group, point); }, &lines);
  }
  return report::Chart(
      "Peak torque of the drives over the pressure",
      "Joints with a pneumatic element. Points: SEA-PEA actuators. Lines: rigid ones.",
      "pressure, bar", 264, {{"peak torque, N m", std::move(lines), "0:"}});
}

std::string OutcomeOf(const PressurePoint& point) {
  const ClosedLoopScore& score = point.trial.score;
  if (score.fell_at_s) return "falls after " + Short(*score.fell_at_s) + " s";
  return score.faulted ? "fault" : Short(score.mse_rad2);
}

}  // namespace

report::Section PressureSection(const PressureSweepConfig& config,
                                const std::vector<PressurePoint>& points, double seconds) {
  report::Section section = {.id = "tune-pressure",
                             .title = "Pneumatic elements against rigid actuators"};
  const PressurePoint* best = BestPressure(points);
  section.paragraphs = {
      best == nullptr ? "The robot stands at none of the pressures."
                      : "Least electrical energy: at " + Short(*best->pressure_bar) + " bar, " +
                            Short(best->trial.performance.drawn_J) + " J.",
      "Energies from the first tick on, of all joints, as sinew-performance computes them; the air "
      "that compressor and leak cost is in none of them."};
  const std::vector<PeakGroup> groups = PeakGroups(config);
  report::Table table = {
      .title = "The motion at each pressure",
      .header = {"pressure, bar", "MSE, rad2", "positive work, J", "net work, J", "electrical, J"}};
  for (const PeakGroup& group : groups) table.header.push_back("peak " + group.name + ", N m");
  for (const PressurePoint& point : points) {
    const performance::RobotPerformanceOutput& of = point.trial.performance;
    table.rows.push_back({PressureName(point), OutcomeOf(point), Short(of.energies.positive_J),
                          Short(of.energies.net_J), Short(of.drawn_J)});
    for (const PeakGroup& group : groups) {
      table.rows.back().push_back(Short(PeakOf(group, point)));
    }
  }
  section.tables.push_back(table);
  if (best != nullptr) section.pictures = {EnergyPicture(points), PeakPicture(config, points)};
  section.seconds = seconds;
  return section;
}

nlohmann::ordered_json PressureJson(const PressureSweepConfig& config,
                                    const std::vector<PressurePoint>& points) {
  const auto of_point = [&config](const PressurePoint& point) {
    const RobotTrialResult& trial = point.trial;
    nlohmann::ordered_json json = {{"pressure_bar", nullptr},
                                   {"mse_rad2", nullptr},
                                   {"worst_rad", trial.score.worst_rad},
                                   {"fell_at_s", nullptr},
                                   {"faulted", trial.score.faulted},
                                   {"positive_work_J", trial.performance.energies.positive_J},
                                   {"net_work_J", trial.performance.energies.net_J},
                                   {"copper_loss_J", trial.performance.energies.copper_loss_J},
                                   {"electrical_J", trial.performance.drawn_J},
                                   {"lifting_work_J", trial.performance.lifting_J},
                                   {"joints", nlohmann::ordered_json::object()}};
    if (point.pressure_bar) json["pressure_bar"] = *point.pressure_bar;
    if (point.stands()) json["mse_rad2"] = trial.score.mse_rad2;
    if (trial.score.fell_at_s) json["fell_at_s"] = *trial.score.fell_at_s;
    for (std::size_t j = 0; j < JointsOf(config).size(); ++j) {
      const performance::Energies& energies = trial.performance.joint[j].energies;
      json["joints"][JointsOf(config)[j].name] = {
          {"peak_torque_Nm", trial.peak_torque_Nm[j]},
          {"positive_work_J", energies.positive_J},
          {"net_work_J", energies.net_J},
          {"electrical_J", energies.electrical_drawn_J},
          {"least_pressure_bar", trial.least_pressure_bar[j]},
          {"most_pressure_bar", trial.most_pressure_bar[j]}};
    }
    return json;
  };
  const PressurePoint* best = BestPressure(points);
  nlohmann::ordered_json json = {{"rigid", of_point(points.front())},
                                 {"best_pressure_bar", nullptr},
                                 {"pressures", nlohmann::ordered_json::array()}};
  if (best != nullptr) json["best_pressure_bar"] = *best->pressure_bar;
  for (const PressurePoint& point : points) {
    if (point.pressure_bar) json["pressures"].push_back(of_point(point));
  }
  return json;
}

}  // namespace sinew::tune
