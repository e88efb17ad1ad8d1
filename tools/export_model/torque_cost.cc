#include <algorithm>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/model/arm/arm_fit.h"
#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/payloads/payloads.h"
#include "tools/export_model/cost.h"

namespace sinew::export_model {
namespace {

// Error of each joint's torque with these terms, rms, Nm or N.
using TorqueError = std::function<std::vector<double>(const actuator::RobotModel&)>;

TorqueError OfAnArm(const actuator::RobotModel& robot, const arm::Chain& chain,
                    const arm::ArmRuns& runs, const identify::ProcessingOptions& wished) {
  const arm::Arm arm(arm::WithPayloads(chain, robot.payloads), robot);
  const identify::ProcessingOptions processing = identify::Resolve(wished, runs.front());
  return [arm, &runs, processing](const actuator::RobotModel& model) {
    return arm.ErrorOf(runs, model, arm.dynamics().nominal(), processing).rms_Nm;
  };
}

TorqueError OfJointsAlone(const arm::ArmRuns& runs, const identify::ProcessingOptions& wished) {
  return [&runs, wished](const actuator::RobotModel& model) {
    std::vector<double> errors;
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
      const identify::ProcessingOptions processing = identify::Resolve(wished, runs[j]);
      const identify::Design design(identify::MakeStates(runs[j], model.joints[j], processing),
                                    processing);
      errors.push_back(identify::ErrorOf(design, model.joints[j]).rms);
    }
    return errors;
  };
}

// Terms that the balance of torque has.
std::size_t TermsOfTorque(const actuator::JointModel& joint) {
  return static_cast<std::size_t>(
      std::count_if(joint.terms.begin(), joint.terms.end(),
                    [&joint](const actuator::Term& term) { return joint.Counts(term); }));
}

// Indices of the dropped parts of each joint of the robot.
std::vector<std::vector<std::size_t>> PartsByJoint(const std::vector<Dropped>& dropped,
                                                   const actuator::RobotModel& robot) {
  std::vector<std::vector<std::size_t>> out(robot.joints.size());
  for (std::size_t i = 0; i < dropped.size(); ++i) {
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      if (robot.joints[j].name == dropped[i].joint) out[j].push_back(i);
    }
  }
  return out;
}

Cost TorqueCost(const std::string& effect, const actuator::JointModel& whole,
                const actuator::JointModel& reduced, double without, double with) {
  Cost cost{whole.name, effect, std::nullopt, std::nullopt, ""};
  if (TermsOfTorque(whole) == TermsOfTorque(reduced)) {
    cost.why_not = "it has no part in the balance of torque";
  } else {
    cost.without = without;
    cost.with = with;
  }
  return cost;
}

}  // namespace

void RequireFixedBase(const actuator::RobotModel& robot) {
  if (!robot.floating_base) return;
  throw std::invalid_argument(
      "the robot stands on its feet (floating_base), expected one on a fixed base: what its joints "
      "carry depends on the forces under its soles");
}

Costs TorqueCostsOf(const std::vector<Dropped>& dropped, const actuator::RobotModel& robot,
                    const arm::Chain& chain, const std::vector<std::vector<types::Run>>& runs,
                    const identify::ProcessingOptions& wished) {
  RequireFixedBase(robot);
  const bool is_arm =
      std::any_of(robot.joints.begin(), robot.joints.end(),
                  [](const actuator::JointModel& joint) { return joint.Find("rigid_body") >= 0; });
  const TorqueError error_of =
      is_arm ? OfAnArm(robot, chain, runs, wished) : OfJointsAlone(runs, wished);
  const std::vector<double> with = error_of(robot);
  const std::vector<std::vector<std::size_t>> parts = PartsByJoint(dropped, robot);
  std::size_t most = 0;
  for (const std::vector<std::size_t>& of_joint : parts) most = std::max(most, of_joint.size());

  Costs costs{Measure::kPredictedTorque, std::vector<Cost>(dropped.size())};
  actuator::RobotModel none = robot;
  // The error of a joint is one of its own terms alone: a part of every joint is dropped at once.
  for (std::size_t k = 0; k < most; ++k) {
    actuator::RobotModel reduced = robot;
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (k >= parts[j].size()) continue;
      const std::string& effect = dropped[parts[j][k]].effect;
      reduced.joints[j] = Without(robot.joints[j], effect);
      none.joints[j] = Without(none.joints[j], effect);
    }
    const std::vector<double> without = error_of(reduced);
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (k >= parts[j].size()) continue;
      const std::size_t part = parts[j][k];
      costs.of[part] =
          TorqueCost(dropped[part].effect, robot.joints[j], reduced.joints[j], without[j], with[j]);
    }
  }
  if (most < 2) return costs;
  const std::vector<double> without = error_of(none);
  for (std::size_t j = 0; j < parts.size(); ++j) {
    if (parts[j].size() < 2) continue;
    costs.of.push_back(TorqueCost("all", robot.joints[j], none.joints[j], without[j], with[j]));
  }
  return costs;
}

}  // namespace sinew::export_model
