#include "components/model/actuator/model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::actuator {

namespace {

using Buffer = std::array<double, effects::kMaxParameters>;

void CopyNonlinear(const Term& term, Buffer* psi) noexcept {
  for (std::size_t i = 0; i < term.nonlinear.size(); ++i) (*psi)[i] = term.nonlinear[i].value;
}

double Evaluate(const Term& term, const effects::JointSample& x,
                std::span<const double> memory) noexcept {
  Buffer psi{}, phi{};
  CopyNonlinear(term, &psi);
  term.effect->Regressors(x, {psi.data(), term.nonlinear.size()}, memory,
                          {phi.data(), term.linear.size()});
  double torque = 0.0;
  for (std::size_t i = 0; i < term.linear.size(); ++i) torque += term.linear[i].value * phi[i];
  return torque;
}

// Calls f(term, its part of the memory) for every term.
template <class Memory, class Function>
void ForEach(const std::vector<Term>& terms, Memory memory, Function f) {
  std::size_t at = 0;
  for (const Term& term : terms) {
    const auto size = static_cast<std::size_t>(term.effect->memory_size());
    f(term, memory.subspan(at, size));
    at += size;
  }
}

}  // namespace

double PriorSpread(const ParameterValue& declared) {
  if (declared.tolerance_absolute > 0.0) return declared.tolerance_absolute;
  return declared.tolerance * std::abs(declared.value);
}

double RelativeSpread(const ParameterValue& declared) {
  return declared.value != 0.0 ? PriorSpread(declared) / std::abs(declared.value) : 0.0;
}

std::vector<double> NonlinearValues(const Term& term) {
  std::vector<double> psi;
  for (const ParameterValue& value : term.nonlinear) psi.push_back(value.value);
  return psi;
}

Term MakeTerm(std::string_view effect_name, const effects::JointConstants& constants,
              std::optional<effects::Balance> balance) {
  Term term;
  term.effect = effects::MakeEffect(effect_name, constants, balance);
  for (const effects::ParameterInfo& info : term.effect->info().linear) {
    term.linear.push_back({.value = info.default_value, .half_width_95 = std::nullopt});
  }
  for (const effects::ParameterInfo& info : term.effect->info().nonlinear) {
    term.nonlinear.push_back({.value = info.default_value, .half_width_95 = std::nullopt});
  }
  return term;
}

int JointModel::Find(std::string_view effect_name, std::optional<effects::Balance> of) const {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const effects::EffectInfo& info = terms[i].effect->info();
    if (info.name == effect_name && (!of || info.balance == *of)) return static_cast<int>(i);
  }
  return -1;
}

bool JointModel::Declares(effects::Balance of) const {
  return std::any_of(terms.begin(), terms.end(), [of](const Term& term) {
    return term.effect->info().balance == of && term.effect->info().role == effects::Role::kDrive;
  });
}

double JointModel::Parameter(std::string_view effect_name, std::string_view parameter) const {
  for (const Term& term : terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.name != effect_name) continue;
    for (std::size_t i = 0; i < info.linear.size(); ++i) {
      if (info.linear[i].name == parameter) return term.linear[i].value;
    }
    for (std::size_t i = 0; i < info.nonlinear.size(); ++i) {
      if (info.nonlinear[i].name == parameter) return term.nonlinear[i].value;
    }
  }
  throw std::invalid_argument("joint '" + name + "' has no parameter '" + std::string(parameter) +
                              "' of an effect '" + std::string(effect_name) + "'");
}

int JointModel::memory_size() const {
  int size = 0;
  for (const Term& term : terms) size += term.effect->memory_size();
  return size;
}

void JointModel::ResetMemory(const effects::JointSample& x, std::span<double> memory) const {
  ForEach(terms, memory, [&](const Term& term, std::span<double> part) {
    if (part.empty()) return;
    Buffer psi{};
    CopyNonlinear(term, &psi);
    term.effect->ResetMemory(x, {psi.data(), term.nonlinear.size()}, part);
  });
}

void JointModel::Advance(const effects::JointSample& x, double dt_s,
                         std::span<double> memory) const noexcept {
  if (memory.empty()) return;
  ForEach(terms, memory, [&](const Term& term, std::span<double> part) {
    if (part.empty()) return;
    Buffer psi{};
    CopyNonlinear(term, &psi);
    term.effect->Advance(x, dt_s, {psi.data(), term.nonlinear.size()}, part);
  });
}

double JointModel::TermTorque(int index, const effects::JointSample& x,
                              std::span<const double> memory) const noexcept {
  std::size_t at = 0;
  for (int i = 0; i < index; ++i) {
    at += static_cast<std::size_t>(terms[static_cast<std::size_t>(i)].effect->memory_size());
  }
  const Term& term = terms[static_cast<std::size_t>(index)];
  return Evaluate(term, x,
                  memory.subspan(at, static_cast<std::size_t>(term.effect->memory_size())));
}

double JointModel::Torque(effects::Role role, const effects::JointSample& x,
                          std::span<const double> memory) const noexcept {
  double torque = 0.0;
  ForEach(terms, memory, [&](const Term& term, std::span<const double> part) {
    if (Counts(term) && term.effect->info().role == role) torque += Evaluate(term, x, part);
  });
  return torque;
}

double JointModel::SideTorque(effects::Side side, const effects::JointSample& x,
                              std::span<const double> memory) const noexcept {
  double torque = 0.0;
  ForEach(terms, memory, [&](const Term& term, std::span<const double> part) {
    if (Counts(term) && term.effect->info().side == side) torque += Evaluate(term, x, part);
  });
  return torque;
}

double JointModel::RequiredDriveInput(const effects::JointSample& x, std::span<const double> memory,
                                      bool* reached) const noexcept {
  // Some passive terms follow the drive (load-dependent friction, saturation): the balance is
  // implicit in the drive input. Where the dependence is weak the fixed point is reached in a few
  // rounds; a model without such terms stops after the second.
  constexpr double kReached = 1e-6;
  if (reached != nullptr) *reached = true;
  effects::JointSample y = x;
  y.drive_input = 1.0;
  const double gain = Torque(effects::Role::kDrive, y, memory);
  y.drive_input = 0.0;
  if (!(gain > 0.0)) return 0.0;
  const double inertia = Torque(effects::Role::kInertia, y, memory);
  const auto missing = [&](double input) {
    y.drive_input = input;
    return -(inertia + Torque(effects::Role::kPassive, y, memory)) / gain - input;
  };
  const double without = missing(0.0);
  if (!std::isfinite(without)) return without;
  double input = without, change = 0.0;
  for (int round = 0; round < 30; ++round) {
    change = missing(input);
    input += change;
    if (!(std::abs(change) > 1e-12 * (1.0 + std::abs(input)))) break;
  }
  if (std::isfinite(input) && std::abs(change) <= kReached * (1.0 + std::abs(input))) return input;

  // A drive that saturates: its torque has a maximum. The smallest input that is enough, or the one
  // that comes closest, up to four times the input without saturation.
  constexpr int kSteps = 16, kTimes = 4, kHalvings = 50;
  double closest = 0.0, least = std::abs(without);
  for (int k = 1; k <= kSteps * kTimes; ++k) {
    const double before = without * (k - 1) / kSteps, after = without * k / kSteps;
    const double left = missing(after);
    if (left * without <= 0.0) {
      double low = before, high = after;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (low + high);
        (missing(middle) * without > 0.0 ? low : high) = middle;
      }
      return high;
    }
    if (std::abs(left) < least) {
      least = std::abs(left);
      closest = after;
    }
  }
  if (reached != nullptr) *reached = false;
  return closest;
}

double JointModel::RequiredDriveTorque(const effects::JointSample& x,
                                       std::span<const double> memory) const noexcept {
  effects::JointSample y = x;
  y.drive_input = RequiredDriveInput(x, memory);
  return -(Torque(effects::Role::kInertia, y, memory) + Torque(effects::Role::kPassive, y, memory));
}

double JointModel::Residual(const effects::JointSample& x,
                            std::span<const double> memory) const noexcept {
  double torque = 0.0;
  ForEach(terms, memory, [&](const Term& term, std::span<const double> part) {
    if (Counts(term)) torque += Evaluate(term, x, part);
  });
  return torque;
}

void RemakeEffects(JointModel* model) {
  effects::JointConstants& constants = model->constants;
  const auto term = [&](const char* effect) -> const Term* {
    const int at = model->Find(effect, effects::Balance::kMotion);
    return at < 0 ? nullptr : &model->terms[static_cast<std::size_t>(at)];
  };
  const Term* torque = term("pneumatic_torque");
  const Term* stiffness = term("pneumatic_stiffness");
  constants.pneumatic_torque_Nm_bar = torque != nullptr ? torque->linear.front().value : 0.0;
  constants.pneumatic_stiffness_Nm_rad_bar =
      stiffness != nullptr ? stiffness->linear.front().value : 0.0;
  constants.pneumatic_rest_rad = stiffness != nullptr ? stiffness->nonlinear.front().value : 0.0;
  // The drive is what the link puts on it, the load, where both torques of a gear are measured.
  const bool behind = term("drive_torque") != nullptr && term("load_force") != nullptr;
  const double share = DriveShare(*model, effects::Balance::kMotion);
  const auto taken = [&](const char* effect) {
    const Term* of = term(effect);
    return of != nullptr && !behind ? of->linear.front().value / share : 0.0;
  };
  constants.drive_coulomb_Nm = taken("coulomb");
  constants.drive_viscous_Nm_s_rad = taken("viscous") + taken("motor_viscous");
  for (Term& each : model->terms) {
    const effects::EffectInfo& info = each.effect->info();
    each.effect = effects::MakeEffect(std::string(info.name), constants, info.balance);
  }
}

double DriveShare(const JointModel& model, effects::Balance balance) {
  for (const Term& term : model.terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.role != effects::Role::kDrive || info.balance != balance) continue;
    const double ideal = info.linear[0].dimension == effects::Dimension::kNone
                             ? 1.0
                             : model.constants.force_constant_N_V;
    const double share = term.linear[0].value / (ideal > 0.0 ? ideal : 1.0);
    return share != 0.0 ? share : 1.0;
  }
  return 1.0;
}

double PhysicalValue(const JointModel& model, int term, int linear_parameter) {
  const Term& of = model.terms.at(static_cast<std::size_t>(term));
  const auto at = static_cast<std::size_t>(linear_parameter);
  const double value = of.linear.at(at).value;
  const effects::EffectInfo& info = of.effect->info();
  return info.linear[at].relative_to_drive ? value / DriveShare(model, info.balance) : value;
}

Term PhysicalTerm(const JointModel& model, int term) {
  Term out = model.terms.at(static_cast<std::size_t>(term));
  for (std::size_t i = 0; i < out.linear.size(); ++i) {
    ParameterValue& value = out.linear[i];
    const double physical = PhysicalValue(model, term, static_cast<int>(i));
    if (value.half_width_95 && value.value != 0.0) {
      *value.half_width_95 *= std::abs(physical / value.value);
    }
    value.value = physical;
  }
  return out;
}

}  // namespace sinew::actuator
