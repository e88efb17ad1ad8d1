#include "components/base/types/text.h"
#include "tools/export_model/write_model.h"

namespace sinew::export_model {
namespace {

// Positions in thousandths of the unit.
std::string ErrorText(double value, Measure measure, std::string_view unit) {
  const bool milli = measure == Measure::kSimulatedPosition;
  return types::Text("%.3g %s%s", milli ? 1e3 * value : value, milli ? "m" : "",
                     std::string(unit).c_str());
}

std::string CostText(const Cost& cost, Measure measure, std::string_view unit) {
  if (!cost.without || !cost.with) return "; " + cost.why_not;
  return (measure == Measure::kSimulatedPosition ? "; simulated position wrong by "
                                                 : "; predicted torque wrong by ") +
         ErrorText(*cost.without, measure, unit) + " rms without, by " +
         ErrorText(*cost.with, measure, unit) + " rms with";
}

std::string Heading(Measure measure, const std::string& recordings) {
  if (measure == Measure::kSimulatedPosition) {
    return "Errors below: simulated beside " + recordings + ".";
  }
  return "Errors below: the torque that each joint needs for the motion of " + recordings +
         ", predicted by its balance with the bodies of the URDF, less the measured one; robots of "
         "several joints are not simulated beside a recording.";
}

}  // namespace

Remarks MakeRemarks(Format format, const actuator::RobotModel& robot, const arm::Base& base,
                    const std::string& source, const std::vector<Dropped>& dropped,
                    const Costs& costs, const std::string& recordings) {
  const std::string name(FormatName(format));
  Remarks remarks = {"Written by sinew export-model from " + source +
                     ". Units: m, kg, s, rad, N, N m."};
  if (!recordings.empty()) remarks.push_back(Heading(costs.measure, recordings));
  const auto cost_text = [&](const Cost& cost) {
    return CostText(cost, costs.measure, UnitOf(costs.measure, robot, cost.joint));
  };
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    const Dropped& part = dropped[i];
    remarks.push_back("Not in " + name + ": joint " + part.joint + ", " + part.effect + " (" +
                      part.parameters + ")" +
                      (i < costs.of.size() ? cost_text(costs.of[i]) : std::string()) + ".");
  }
  if (base.mass_kg > 0.0 && !robot.floating_base && format != Format::kUrdf) {
    remarks.push_back("Not in " + name + ": mass " + types::Text("%.6g", base.mass_kg) +
                      " kg and inertia of the base link " + base.link_name +
                      ", which is fixed to the world.");
  }
  for (std::size_t i = dropped.size(); i < costs.of.size(); ++i) {
    remarks.push_back("All of these of joint " + costs.of[i].joint + cost_text(costs.of[i]) + ".");
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
