#include "tools/export_model/remarks.h"

#include <cstdio>

namespace sinew::export_model {
namespace {

std::string InMilli(double value, types::JointKind kind) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %s", 1e3 * value,
                kind == types::JointKind::kRotary ? "mrad" : "mm");
  return text;
}

std::string CostText(const Cost& cost, types::JointKind kind) {
  if (!cost.without || !cost.with) return "; " + cost.why_not;
  return "; simulated position wrong by " + InMilli(*cost.without, kind) + " rms without, by " +
         InMilli(*cost.with, kind) + " rms with";
}

}  // namespace

Remarks MakeRemarks(Format format, const actuator::RobotModel& robot, const std::string& source,
                    const std::vector<Dropped>& dropped, const std::vector<Cost>& costs,
                    const std::string& recordings, types::JointKind kind) {
  const std::string name(FormatName(format));
  Remarks remarks = {"Written by sinew export-model from " + source +
                     ". Units: m, kg, s, rad, N, N m."};
  if (!recordings.empty()) remarks.push_back("Errors below: simulated beside " + recordings + ".");
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    const Dropped& part = dropped[i];
    remarks.push_back("Not in " + name + ": joint " + part.joint + ", " + part.effect + " (" +
                      part.parameters + ")" +
                      (i < costs.size() ? CostText(costs[i], kind) : std::string()) + ".");
  }
  if (costs.size() > dropped.size()) {
    remarks.push_back("All of these" + CostText(costs.back(), kind) + ".");
  }
  for (const actuator::JointModel& joint : robot.joints) {
    for (const actuator::Term& term : joint.terms) {
      if (PlaceOf(term) != Place::kInput) continue;
      remarks.push_back("From outside: joint " + joint.name + ", " + term.effect->info().name +
                        "; here it is 0.");
    }
  }
  return remarks;
}

}  // namespace sinew::export_model
