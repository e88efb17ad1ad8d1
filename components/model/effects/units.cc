#include <iterator>

#include "components/model/effects/effect.h"

namespace sinew::effects {

namespace {

// In the order of their enumerations.
struct Suffix {
  Dimension dimension;
  std::string_view rotary, linear;
};
constexpr Suffix kSuffixes[] = {
    {Dimension::kNone, "", ""},
    {Dimension::kTorque, "Nm", "N"},
    {Dimension::kViscous, "Nm_s_rad", "N_s_m"},
    {Dimension::kQuadraticViscous, "Nm_s2_rad2", "N_s2_m2"},
    {Dimension::kInertia, "kg_m2", "kg"},
    {Dimension::kAngle, "rad", "m"},
    {Dimension::kVelocity, "rad_s", "m_s"},
    {Dimension::kFrequency, "Hz", "Hz"},
    {Dimension::kTime, "s", "s"},
    {Dimension::kMass, "kg", "kg"},
    {Dimension::kTorquePerBar, "Nm_bar", "N_bar"},
    {Dimension::kStiffness, "Nm_rad", "N_m"},
    {Dimension::kStiffnessPerBar, "Nm_rad_bar", "N_m_bar"},
    {Dimension::kTorquePerKelvin, "Nm_K", "N_K"},
    {Dimension::kTorquePerAmpere, "Nm_A", "N_A"},
    {Dimension::kTorquePerVolt, "Nm_V", "N_V"},
    {Dimension::kInertiaTime, "kg_m2_s", "kg_s"},
    {Dimension::kPressure, "bar", "bar"},
    {Dimension::kTemperature, "degC", "degC"},
    {Dimension::kLength, "m", "m"},
    {Dimension::kPerTorque, "per_Nm", "per_N"},
    {Dimension::kCurrent, "A", "A"},
    {Dimension::kPerCurrentSquared, "per_A2", "per_A2"},
    {Dimension::kViscousPerKelvin, "Nm_s_rad_K", "N_s_m_K"},
    {Dimension::kInertiaTimeSquared, "kg_m2_s2", "kg_s2"},
    {Dimension::kAnglePerTorque, "rad_Nm", "m_N"},
    {Dimension::kRate, "1_s", "1_s"},
};

static_assert(std::size(kSuffixes) == static_cast<std::size_t>(Dimension::kRate) + 1);

struct BalanceWords {
  Balance balance;
  std::string_view name, rotary_unit, linear_unit;
};
constexpr BalanceWords kBalances[] = {
    {Balance::kMotion, "motion", "Nm", "N"},
    {Balance::kLink, "link", "Nm", "N"},
    {Balance::kPlay, "play", "Nm", "N"},
    {Balance::kGas, "gas", "bar", "bar"},
    {Balance::kKinematic, "kinematic", "rad", "m"},
};

}  // namespace

std::string_view UnitSuffix(Dimension dimension, types::JointKind kind) {
  const Suffix& row = kSuffixes[static_cast<std::size_t>(dimension)];
  return kind == types::JointKind::kRevolute ? row.rotary : row.linear;
}

std::string_view BalanceName(Balance balance) {
  return kBalances[static_cast<std::size_t>(balance)].name;
}

std::string_view BalanceUnit(Balance balance, types::JointKind kind) {
  const BalanceWords& row = kBalances[static_cast<std::size_t>(balance)];
  return kind == types::JointKind::kRevolute ? row.rotary_unit : row.linear_unit;
}

std::string ParameterKey(const ParameterInfo& info, types::JointKind kind) {
  const std::string_view unit = UnitSuffix(info.dimension, kind);
  return unit.empty() ? info.name : info.name + "_" + std::string(unit);
}

}  // namespace sinew::effects
