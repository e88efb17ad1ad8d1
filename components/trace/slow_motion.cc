#include "components/trace/slow_motion.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace sinew::trace {

namespace {

constexpr std::size_t kFewestTrainRows = 400;
constexpr std::size_t kFewestSealedRows = 50;
constexpr std::array<std::string_view, 3> kShownByCreeping = {"coulomb", "gravity", "offset"};

}  // namespace

std::vector<std::string> EffectsOfMotorAngle(const actuator::JointModel& model) {
  std::vector<std::string> out;
  for (const auto& [name, balance] : effects::EffectForms()) {
    if (balance != model.balance) continue;
    const auto effect = effects::MakeEffect(name, model.constants, balance);
    if (effect->info().variable == "motor_position_rad") out.push_back(name);
  }
  return out;
}

actuator::JointModel HeldForSlowMotion(const actuator::JointModel& model) {
  actuator::JointModel out = model;
  for (actuator::Term& term : out.terms) {
    const std::string& name = term.effect->info().name;
    if (std::find(kShownByCreeping.begin(), kShownByCreeping.end(), name) !=
        kShownByCreeping.end()) {
      continue;
    }
    for (actuator::ParameterValue& value : term.linear) value.fixed = true;
    for (actuator::ParameterValue& value : term.nonlinear) value.fixed = true;
  }
  return out;
}

bool ShowsSlowMotion(const identify::Design& train, const identify::Design& sealed) {
  return train.states().measured.count("motor_position_rad") != 0 &&
         train.rows().UsedRows().size() >= kFewestTrainRows &&
         sealed.rows().UsedRows().size() >= kFewestSealedRows;
}

TraceResult WithSlowMotion(TraceResult first, TraceResult slow) {
  for (RoundReport& round : slow.rounds) {
    round.slow_motion = true;
    first.rounds.push_back(std::move(round));
  }
  if (slow.effects.empty()) return first;
  const bool alone = first.effects.empty();
  for (FoundEffect& effect : slow.effects) {
    actuator::Term term = slow.corrected.terms[static_cast<std::size_t>(effect.term)];
    first.corrected.terms.push_back(std::move(term));
    effect.term = static_cast<int>(first.corrected.terms.size()) - 1;
    effect.slow_motion = true;
    std::erase_if(first.not_excited,
                  [&](const NotExcited& hidden) { return hidden.effect == effect.name; });
    first.effects.push_back(std::move(effect));
  }
  if (alone) {
    first.slow_motion = true;
    slow.rounds = std::move(first.rounds);
    static_cast<Judgement&>(first) = std::move(static_cast<Judgement&>(slow));
  }
  first.verdict = Verdict::kEffect;
  first.unexplained = {};
  return first;
}

}  // namespace sinew::trace
