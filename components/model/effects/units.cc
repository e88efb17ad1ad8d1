#include "components/model/effects/effect.h"

namespace sinew::effects {

std::string_view UnitSuffix(Dimension dimension, types::JointKind kind) {
  const bool rotary = kind == types::JointKind::kRevolute;
  switch (dimension) {
    case Dimension::kNone:
      return "";
    case Dimension::kTorque:
      return rotary ? "Nm" : "N";
    case Dimension::kViscous:
      return rotary ? "Nm_s_rad" : "N_s_m";
    case Dimension::kQuadraticViscous:
      return rotary ? "Nm_s2_rad2" : "N_s2_m2";
    case Dimension::kInertia:
      return rotary ? "kg_m2" : "kg";
    case Dimension::kAngle:
      return rotary ? "rad" : "m";
    case Dimension::kVelocity:
      return rotary ? "rad_s" : "m_s";
    case Dimension::kFrequency:
      return "Hz";
    case Dimension::kTime:
      return "s";
    case Dimension::kMass:
      return "kg";
    case Dimension::kTorquePerBar:
      return rotary ? "Nm_bar" : "N_bar";
    case Dimension::kStiffness:
      return rotary ? "Nm_rad" : "N_m";
    case Dimension::kStiffnessPerBar:
      return rotary ? "Nm_rad_bar" : "N_m_bar";
    case Dimension::kTorquePerKelvin:
      return rotary ? "Nm_K" : "N_K";
    case Dimension::kTorquePerAmpere:
      return rotary ? "Nm_A" : "N_A";
    case Dimension::kTorquePerVolt:
      return rotary ? "Nm_V" : "N_V";
    case Dimension::kInertiaTime:
      return rotary ? "kg_m2_s" : "kg_s";
    case Dimension::kPressure:
      return "bar";
    case Dimension::kTemperature:
      return "degC";
    case Dimension::kLength:
      return "m";
    case Dimension::kPerTorque:
      return rotary ? "per_Nm" : "per_N";
    case Dimension::kCurrent:
      return "A";
    case Dimension::kPerCurrentSquared:
      return "per_A2";
    case Dimension::kViscousPerKelvin:
      return rotary ? "Nm_s_rad_K" : "N_s_m_K";
    case Dimension::kInertiaTimeSquared:
      return rotary ? "kg_m2_s2" : "kg_s2";
    case Dimension::kAnglePerTorque:
      return rotary ? "rad_Nm" : "m_N";
    case Dimension::kRate:
      return "1_s";
  }
  return "";
}

std::string_view BalanceName(Balance balance) {
  switch (balance) {
    case Balance::kMotion:
      return "motion";
    case Balance::kLink:
      return "link";
    case Balance::kPlay:
      return "play";
    case Balance::kGas:
      return "gas";
    case Balance::kKinematic:
      return "kinematic";
  }
  return "";
}

std::string_view BalanceUnit(Balance balance, types::JointKind kind) {
  const bool rotary = kind == types::JointKind::kRevolute;
  switch (balance) {
    case Balance::kGas:
      return "bar";
    case Balance::kKinematic:
      return rotary ? "rad" : "m";
    default:
      return rotary ? "Nm" : "N";
  }
}

std::string ParameterKey(const ParameterInfo& info, types::JointKind kind) {
  const std::string_view unit = UnitSuffix(info.dimension, kind);
  return unit.empty() ? info.name : info.name + "_" + std::string(unit);
}

}  // namespace sinew::effects
