// The registry: effect_list.inc is written by CMake from the list of files in CMakeLists.txt.
#include <algorithm>
#include <stdexcept>

#include "components/base/types/joined.h"
#include "components/model/effects/define.h"
#include "components/model/effects/effect.h"

#define SINEW_EFFECT(name, balance, space)                                \
  namespace sinew::effects::space {                                       \
  std::unique_ptr<Effect> Make(EffectInfo info, const JointConstants& c); \
  }
#include "effect_list.inc"
#undef SINEW_EFFECT

namespace sinew::effects {

namespace {

using Maker = std::unique_ptr<Effect> (*)(EffectInfo, const JointConstants&);

struct Entry {
  std::string_view name;
  Balance balance;
  Maker make;
};

constexpr Entry kCatalogue[] = {
#define SINEW_EFFECT(name, balance, space) {#name, Balance::balance, &space::Make},
#include "effect_list.inc"
#undef SINEW_EFFECT
};

class MemorylessEffect final : public Effect {
 public:
  MemorylessEffect(const JointConstants& constants, EffectInfo info, RegressorFunction regressors)
      : Effect(std::move(info)), constants_(constants), regressors_(regressors) {}

  void Regressors(const JointSample& x, std::span<const double> psi,
                  std::span<const double> /*memory*/,
                  std::span<double> phi) const noexcept override {
    regressors_(x, constants_, psi, phi);
  }

 private:
  JointConstants constants_;
  RegressorFunction regressors_;
};

}  // namespace

std::unique_ptr<Effect> MakeMemoryless(const JointConstants& constants, EffectInfo info,
                                       RegressorFunction regressors) {
  return std::make_unique<MemorylessEffect>(constants, std::move(info), regressors);
}

std::unique_ptr<Effect> MakeEffect(std::string_view name, const JointConstants& constants,
                                   std::optional<Balance> balance) {
  std::string forms;
  for (const Entry& entry : kCatalogue) {
    if (entry.name != name) continue;
    if (!balance || entry.balance == *balance) {
      EffectInfo info;
      info.name = name;
      info.balance = entry.balance;
      return entry.make(std::move(info), constants);
    }
    if (!forms.empty()) forms += ", ";
    forms += BalanceName(entry.balance);
  }
  if (!forms.empty()) {
    throw std::invalid_argument("effect '" + std::string(name) + "' has no form in the " +
                                std::string(BalanceName(*balance)) + " balance, it has: " + forms);
  }
  throw std::invalid_argument("unknown effect '" + std::string(name) +
                              "', known: " + types::Joined(EffectNames()));
}

std::vector<EffectForm> EffectForms() {
  std::vector<EffectForm> forms;
  for (const Entry& entry : kCatalogue) forms.push_back({std::string(entry.name), entry.balance});
  return forms;
}

std::vector<std::string> EffectNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kCatalogue) {
    if (std::find(names.begin(), names.end(), entry.name) == names.end()) {
      names.emplace_back(entry.name);
    }
  }
  return names;
}

}  // namespace sinew::effects
