#include <algorithm>
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

// Energies over the pressure, the rigid robot's as level lines.
report::Picture EnergyPicture(const std::vector<PressurePoint>& points) {
  report::Picture picture;
  picture.title = "Energies of the motion over the pressure";
  picture.caption = "Points: SEA-PEA actuators. Lines: rigid actuators.";
  picture.script = report::PictureHead(420) + "$points << EOD\n";
  for (const PressurePoint& point : points) {
    if (!point.pressure_bar || !point.stands()) continue;
    picture.script += PictureNumber(*point.pressure_bar);
    for (const EnergySeries& series : kEnergySeries) {
      picture.script += " " + PictureNumber(series.of(point.trial.performance));
    }
    picture.script += "\n";
  }
  picture.script +=
      "EOD\nset xlabel 'pressure, bar'\nset ylabel 'energy, J'\nset yrange [0:]\nplot ";
  int column = 2;
  for (const EnergySeries& series : kEnergySeries) {
    const std::string colour = std::string(" linecolor rgb '") + series.colour + "'";
    if (column > 2) picture.script += ", ";
    picture.script += "$points using 1:" + std::to_string(column++) +
                      " with linespoints pointtype 7 pointsize 0.7 linewidth 2" + colour +
                      " title '" + series.name + "'";
    if (points.front().stands()) {
      picture.script += ", " + PictureNumber(series.of(points.front().trial.performance)) +
                        " with lines dashtype 2 linewidth 1.2" + colour + " notitle";
    }
  }
  picture.script += "\n";
  return picture;
}

report::Picture PeakPicture(const PressureSweepConfig& config,
                            const std::vector<PressurePoint>& points) {
  report::Picture picture;
  picture.title = "Peak torque of the drives over the pressure";
  picture.caption =
      "Joints with a pneumatic element. Points: SEA-PEA actuators. Lines: rigid ones.";
  const std::vector<std::size_t> pneumatic = PneumaticJoints(config.elastic.robot.model);
  std::vector<PeakGroup> groups = PeakGroups(config);
  std::erase_if(groups, [&pneumatic](const PeakGroup& group) {
    return std::find(pneumatic.begin(), pneumatic.end(), group.joints.front()) == pneumatic.end();
  });
  picture.script = report::PictureHead(360) + "$points << EOD\n";
  for (const PressurePoint& point : points) {
    if (!point.pressure_bar || !point.stands()) continue;
    picture.script += PictureNumber(*point.pressure_bar);
    for (const PeakGroup& group : groups) {
      picture.script += " " + PictureNumber(PeakOf(group, point));
    }
    picture.script += "\n";
  }
  picture.script +=
      "EOD\nset xlabel 'pressure, bar'\nset ylabel 'peak torque, N m'\nset yrange [0:]\nplot ";
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const std::string colour = std::string(" linecolor rgb '") +
                               report::kSeriesColours[g % std::size(report::kSeriesColours)] + "'";
    if (g > 0) picture.script += ", ";
    picture.script += "$points using 1:" + std::to_string(g + 2) +
                      " with linespoints pointtype 7 pointsize 0.7 linewidth 2" + colour +
                      " title '" + groups[g].name + "'";
    if (points.front().stands()) {
      picture.script += ", " + PictureNumber(PeakOf(groups[g], points.front())) +
                        " with lines dashtype 2 linewidth 1.2" + colour + " notitle";
    }
  }
  picture.script += "\n";
  return picture;
}

std::string OutcomeOf(const PressurePoint& point) {
  const ClosedLoopScore& score = point.trial.score;
  if (score.fell_at_s) return "falls after " + Short(*score.fell_at_s) + " s";
  return score.faulted ? "fault" : Short(score.mse_rad2);
}

}  // namespace

report::Section PressureSection(const PressureSweepConfig& config,
                                const std::vector<PressurePoint>& points, double seconds) {
  report::Section section;
  section.id = "tune-pressure";
  section.title = "Pneumatic elements against rigid actuators";
  const PressurePoint* best = BestPressure(points);
  section.paragraphs = {
      best == nullptr ? "The robot stands at none of the pressures."
                      : "Least electrical energy: at " + Short(*best->pressure_bar) + " bar, " +
                            Short(best->trial.performance.drawn_J) + " J.",
      "Energies from the first tick on, of all joints, as sinew-performance computes them; the air "
      "that compressor and leak cost is in none of them."};
  const std::vector<PeakGroup> groups = PeakGroups(config);
  report::Table table;
  table.title = "The motion at each pressure";
  table.header = {"pressure, bar", "MSE, rad2", "positive work, J", "net work, J", "electrical, J"};
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
