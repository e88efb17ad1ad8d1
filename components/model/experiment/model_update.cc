#include "components/model/experiment/model_update.h"

#include "components/base/types/angle.h"
#include "components/base/types/text.h"

namespace sinew::experiment {
namespace {

struct Target {
  const char* quantity;
  const char* effect;  // empty: the model's backlash
  const char* parameter;
  bool times_ratio_squared;
};
constexpr Target kTargets[] = {
    {"backlash_deg", "", "backlash_rad", false},
    {"gravity_Nm", "gravity", "gravity_torque", false},
    {"moving_friction_Nm", "coulomb", "coulomb", false},
    {"pressure_slope_Nm_bar", "pneumatic_torque", "pneumatic_torque", false},
    {"rotor_inertia_kg_m2", "rotor_inertia", "rotor_inertia", true},
    {"rotor_viscous_Nm_s_rad", "motor_viscous", "viscous", true},
};

}  // namespace

std::vector<std::string> UpdateModel(const Result& result, const std::string& recording,
                                     const std::string& when, actuator::JointModel* model) {
  std::vector<std::string> changes;
  const auto report = [&](const std::string& effect, const std::string& parameter, double before,
                          double after, double half_width) {
    const std::string text =
        types::Text("%s %.6g -> %.6g +- %.2g (95 %%) by experiment %s", parameter.c_str(), before,
                    after, half_width, result.experiment.c_str());
    changes.push_back(text);
    model->history.push_back({when, effect, recording, text});
  };
  for (const Target& target : kTargets) {
    const Quantity* quantity = result.Find(target.quantity);
    if (quantity == nullptr) continue;
    double value = quantity->estimate.value, half_width = quantity->estimate.half_width_95;
    if (std::string(target.effect).empty()) {
      report("backlash", target.parameter, model->backlash_rad, value * types::kDegree_rad,
             half_width * types::kDegree_rad);
      model->backlash_rad = value * types::kDegree_rad;
      continue;
    }
    const int term = model->Find(target.effect);
    if (term < 0) continue;
    if (target.times_ratio_squared) {
      const double square = model->constants.gear_ratio * model->constants.gear_ratio;
      value *= square;
      half_width *= square;
    }
    actuator::Term& of = model->terms[static_cast<std::size_t>(term)];
    for (std::size_t i = 0; i < of.linear.size(); ++i) {
      if (of.effect->info().linear[i].name != target.parameter) continue;
      report(target.effect, target.parameter, of.linear[i].value, value, half_width);
      of.linear[i].value = value;
      of.linear[i].half_width_95 = half_width;
    }
  }
  return changes;
}

}  // namespace sinew::experiment
