#include <string_view>

#include "components/model/gate/checks.h"

namespace sinew::gate {

namespace {

struct Need {
  std::string_view effect;
  double effects::JointConstants::*constant;
  std::string_view line;  // to add to the joint's constants
};

// A term of this effect is zero, or in units of its input, without the constant.
constexpr Need kNeeds[] = {
    {"drive_current", &effects::JointConstants::torque_constant_Nm_A,
     "torque_constant_Nm_A: <Nm per A at the motor shaft>"},
    {"load_force", &effects::JointConstants::link_length_m,
     "link_length_m: <m from the joint's axis to the load cell>"},
    {"declared_payload", &effects::JointConstants::link_length_m,
     "link_length_m: <m from the joint's axis to the payload>"},
    {"declared_payload", &effects::JointConstants::gravity_m_s2, "gravity_m_s2: 9.81"},
    {"gas_compression", &effects::JointConstants::gas_volume_m3,
     "gas_volume_m3: <m^3 of chamber, tubes and reservoir>"},
};

}  // namespace

std::vector<Measurement> CheckConstants(const actuator::JointModel& model) {
  const std::string rule = "missing_constant";
  std::vector<Measurement> out;
  const bool rotary = model.kind == types::JointKind::kRevolute;
  for (const Need& need : kNeeds) {
    if (model.Find(need.effect) < 0 || model.constants.*need.constant > 0.0) continue;
    // A linear joint carries its payload along a horizontal axis.
    if (!rotary && need.constant == &effects::JointConstants::gravity_m_s2) continue;
    out.push_back({.rule = rule,
                   .statistic = 1.0,
                   .reason = "the term " + std::string(need.effect) +
                             " needs a constant that the model lacks.",
                   .remedy = "Add to `constants` of joint " + model.name + ": `" +
                             std::string(need.line) + "`."});
  }
  if (out.empty()) out.push_back({.rule = rule});
  return out;
}

}  // namespace sinew::gate
