#include "tools/sinew/performance_section.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <sstream>

#include "components/model/report/picture.h"

namespace sinew::tools {

namespace {

using performance::Energies;
using performance::SettleResult;
using report::Short;

constexpr std::size_t kMostCurves = 4;  // as many as there are colours of series
constexpr int kPanel_px = 224;

const char* LengthUnit(const MeasuredSession& m, std::size_t joint) {
  return m.config.linear[joint] ? "m" : "rad";
}

std::string SettleTimeText(const SettleResult& result) {
  if (result.state != SettleResult::State::kSettled) return "not settled";
  return Short(result.settle_s) + " s to " + Short(result.plateau);
}

report::Table JointTable(const MeasuredSession& m) {
  report::Table table;
  table.title = "Joints";
  table.caption =
      "MSE since the session began, sliding RMSE at its end; work at the joint; drawn electrical "
      "energy, the robot's over a common supply.";
  table.header = {
      "joint",       "unit",         "MSE", "sliding RMSE", "absolute work, J", "positive work, J",
      "net work, J", "electrical, J"};
  if (!m.settle.empty()) table.header.push_back("settles");
  const auto row = [&](const std::string& name, const std::string& unit, double mse,
                       const std::string& rms, const Energies& e, double drawn_J,
                       const std::string& settles) {
    std::vector<std::string> cells = {name,
                                      unit,
                                      Short(mse),
                                      rms,
                                      Short(e.absolute_J),
                                      Short(e.positive_J),
                                      Short(e.net_J),
                                      e.electrical_known ? Short(drawn_J) : "-"};
    if (!m.settle.empty()) cells.push_back(settles);
    table.rows.push_back(std::move(cells));
  };
  for (std::size_t j = 0; j < m.config.joint_names.size(); ++j) {
    const auto& joint = m.output.joint[j];
    row(m.config.joint_names[j], LengthUnit(m, j), joint.mean_square_error_rad2,
        joint.rms_known ? Short(joint.sliding_rms_rad) : "-", joint.energies,
        joint.energies.electrical_drawn_J, m.settle.empty() ? "" : SettleTimeText(m.settle[j]));
  }
  row("robot", "", m.output.mean_square_error_rad2, "", m.output.energies, m.output.drawn_J, "");
  return table;
}

// Joints by the largest value of their curve, the largest first.
std::vector<std::size_t> LargestCurves(const MeasuredSession& m) {
  std::vector<double> largest(m.config.joint_names.size(), 0.0);
  for (const auto& rms : m.rms_rad) {
    for (std::size_t j = 0; j < largest.size(); ++j) largest[j] = std::fmax(largest[j], rms[j]);
  }
  std::vector<std::size_t> order(largest.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return largest[a] > largest[b]; });
  order.resize(std::min(order.size(), kMostCurves));
  return order;
}

report::Picture SlidingErrors(const MeasuredSession& m) {
  const std::vector<std::size_t> joints = LargestCurves(m);
  report::Panel panel = {"sliding RMSE, " + std::string(LengthUnit(m, joints.front())), {}, "0:*"};
  for (const std::size_t j : joints) {
    report::Series series = {m.config.joint_names[j],
                             report::kSeriesColours[panel.series.size()],
                             m.time_s,
                             {},
                             "lines lw 2"};
    for (const auto& rms : m.rms_rad) series.y.push_back(rms[j]);
    panel.series.push_back(std::move(series));
  }
  return report::Chart("Sliding RMSE",
                       "Over " + Short(m.config.robot.joints.front().window_s) +
                           " s (7.7), of the joints with the largest.",
                       "time, s", kPanel_px, {std::move(panel)});
}

}  // namespace

report::Section MakePerformanceSection(const MeasuredSession& session, const std::string& id) {
  report::Section section;
  section.id = id;
  section.title = "Performance: " + session.name;
  if (session.output.lifting_known) {
    section.paragraphs.push_back("The centre of mass rose by " + Short(session.output.rise_m) +
                                 " m in all: at least " + Short(session.output.lifting_J) +
                                 " J of positive work.");
  }
  section.tables.push_back(JointTable(session));
  if (!session.time_s.empty()) section.pictures.push_back(SlidingErrors(session));
  return section;
}

nlohmann::ordered_json PerformanceJson(const MeasuredSession& session) {
  const auto work = [](const Energies& e) {
    return nlohmann::ordered_json{{"absolute_work_J", e.absolute_J},
                                  {"positive_work_J", e.positive_J},
                                  {"net_work_J", e.net_J}};
  };
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  for (std::size_t j = 0; j < session.config.joint_names.size(); ++j) {
    const auto& joint = session.output.joint[j];
    const std::string length = LengthUnit(session, j);
    nlohmann::ordered_json one = {{"name", session.config.joint_names[j]}};
    if (joint.error_samples > 0) {
      one["mean_square_error_" + length + "2"] = joint.mean_square_error_rad2;
    }
    one["error_samples"] = joint.error_samples;
    if (joint.rms_known) one["sliding_rms_" + length] = joint.sliding_rms_rad;
    one.update(work(joint.energies));
    if (joint.energies.electrical_known) one["electrical_J"] = joint.energies.electrical_drawn_J;
    if (!session.settle.empty() && session.settle[j].state == SettleResult::State::kSettled) {
      one["settle_s"] = session.settle[j].settle_s;
      one["plateau_" + length] = session.settle[j].plateau;
    }
    joints.push_back(std::move(one));
  }
  nlohmann::ordered_json robot = {
      {"mean_square_error_rad2", session.output.mean_square_error_rad2}};
  robot.update(work(session.output.energies));
  if (session.output.energies.electrical_known) robot["electrical_J"] = session.output.drawn_J;
  if (session.output.lifting_known) {
    robot["rise_m"] = session.output.rise_m;
    robot["lifting_work_J"] = session.output.lifting_J;
  }
  return {{"name", session.name}, {"robot", std::move(robot)}, {"joints", std::move(joints)}};
}

std::string PerformanceCsv(const MeasuredSession& session) {
  std::ostringstream csv;
  csv << "time_s";
  for (std::size_t j = 0; j < session.config.joint_names.size(); ++j) {
    csv << ',' << session.config.joint_names[j] << '_' << LengthUnit(session, j);
  }
  csv << '\n';
  for (std::size_t i = 0; i < session.time_s.size(); ++i) {
    csv << session.time_s[i];
    for (std::size_t j = 0; j < session.config.joint_names.size(); ++j) {
      csv << ',';
      if (std::isfinite(session.rms_rad[i][j])) csv << session.rms_rad[i][j];
    }
    csv << '\n';
  }
  return csv.str();
}

}  // namespace sinew::tools
