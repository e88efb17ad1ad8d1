// The registry: effect_list.inc is written by CMake from the list of files in CMakeLists.txt.
#include <stdexcept>

#include "components/effects/define.h"
#include "components/effects/effect.h"

#define SINEW_EFFECT(name)                               \
  namespace sinew::effects::name {                       \
  std::unique_ptr<Effect> Make(const JointConstants& c); \
  }
#include "effect_list.inc"
#undef SINEW_EFFECT

namespace sinew::effects {

namespace {

using Maker = std::unique_ptr<Effect> (*)(const JointConstants&);

struct Entry {
  std::string_view name;
  Maker make;
};

constexpr Entry kCatalogue[] = {
#define SINEW_EFFECT(name) {#name, &name::Make},
#include "effect_list.inc"
#undef SINEW_EFFECT
};

class MemorylessEffect final : public Effect {
 public:
  MemorylessEffect(const JointConstants& constants, EffectInfo info, RegressorFunction regressors)
      : constants_(constants), info_(std::move(info)), regressors_(regressors) {}

  const EffectInfo& info() const override { return info_; }

  void Regressors(const JointSample& x, std::span<const double> psi,
                  std::span<const double> /*memory*/,
                  std::span<double> phi) const noexcept override {
    regressors_(x, constants_, psi, phi);
  }

 private:
  JointConstants constants_;
  EffectInfo info_;
  RegressorFunction regressors_;
};

}  // namespace

std::unique_ptr<Effect> Memoryless(const JointConstants& constants, EffectInfo info,
                                   RegressorFunction regressors) {
  return std::make_unique<MemorylessEffect>(constants, std::move(info), regressors);
}

std::unique_ptr<Effect> MakeEffect(std::string_view name, const JointConstants& constants) {
  for (const Entry& entry : kCatalogue) {
    if (entry.name == name) return entry.make(constants);
  }
  std::string known;
  for (const Entry& entry : kCatalogue) {
    if (!known.empty()) known += ", ";
    known += entry.name;
  }
  throw std::invalid_argument("unknown effect '" + std::string(name) + "', known: " + known);
}

std::vector<std::string> EffectNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kCatalogue) names.emplace_back(entry.name);
  return names;
}

}  // namespace sinew::effects
