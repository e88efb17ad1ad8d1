#include "tools/export_model/cost.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/verify/verify.h"

namespace sinew::export_model {
namespace {

Cost SimulatedCost(const std::string& effect, const actuator::JointModel& without,
                   const actuator::RobotModel& robot, const std::vector<types::Run>& runs,
                   const identify::ProcessingOptions& processing, double horizon_s) {
  Cost cost;
  cost.joint = without.name;
  cost.effect = effect;
  actuator::RobotModel reduced = robot;
  reduced.joints.front() = without;
  try {
    const free_run::FreeRunResult result =
        verify::FollowRecordings(runs, reduced, robot, processing, horizon_s);
    if (!result.errors) {
      cost.why_not = result.why_not;
      return cost;
    }
    const double rms_without = result.errors->models.at(0).rms;
    const double rms_with = result.errors->models.at(1).rms;
    if (std::isfinite(rms_without)) cost.without = rms_without;
    if (std::isfinite(rms_with)) cost.with = rms_with;
    if (!cost.without) cost.why_not = "without it the simulation diverges";
    if (!cost.with) cost.why_not = "the simulation of the whole model diverges";
  } catch (const std::invalid_argument& error) {
    cost.why_not = std::string("without it there is no simulation: ") + error.what();
  }
  return cost;
}

}  // namespace

std::string_view MeasureName(Measure measure) {
  return measure == Measure::kSimulatedPosition ? "simulated_position" : "predicted_torque";
}

std::string_view UnitOf(Measure measure, const actuator::RobotModel& robot,
                        const std::string& joint_name) {
  const auto joint =
      std::find_if(robot.joints.begin(), robot.joints.end(),
                   [&](const actuator::JointModel& other) { return other.name == joint_name; });
  return effects::UnitSuffix(
      measure == Measure::kSimulatedPosition ? effects::Dimension::kAngle
                                             : effects::Dimension::kTorque,
      joint == robot.joints.end() ? types::JointKind::kRevolute : joint->kind);
}

Costs CostsOf(const std::vector<Dropped>& dropped, const actuator::RobotModel& robot,
              const std::vector<types::Run>& runs, const identify::ProcessingOptions& processing,
              double horizon_s) {
  // With the same model twice, what is thrown is about robot and recordings.
  static_cast<void>(verify::FollowRecordings(runs, robot, robot, processing, horizon_s));
  Costs costs{Measure::kSimulatedPosition, {}};
  actuator::JointModel none = robot.joints.front();
  for (const Dropped& part : dropped) {
    none = Without(none, part.effect);
    costs.of.push_back(SimulatedCost(part.effect, Without(robot.joints.front(), part.effect), robot,
                                     runs, processing, horizon_s));
  }
  if (dropped.size() > 1) {
    costs.of.push_back(SimulatedCost("all", none, robot, runs, processing, horizon_s));
  }
  return costs;
}

}  // namespace sinew::export_model
