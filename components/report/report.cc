#include "components/report/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "components/report/section.h"

namespace sinew::report {

namespace {

std::string Join(const std::vector<std::string>& words, const char* last) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? last : ", ";
    out += words[i];
  }
  return out;
}

}  // namespace

std::string TorqueUnit(effects::JointKind kind) {
  return kind == effects::JointKind::kRotary ? "Nm" : "N";
}

std::string EffectTitle(const std::string& name) {
  return effects::MakeEffect(name, {})->info().title;
}

std::string EffectLabel(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  int alike = 0;
  for (const trace::FoundEffect& other : trace.effects) alike += other.name == effect.name ? 1 : 0;
  const actuator::Term& term = trace.corrected.terms[static_cast<std::size_t>(effect.term)];
  const auto& nonlinear = term.effect->info().nonlinear;
  if (alike < 2 || nonlinear.empty()) return effect.name;
  return effect.name + " (" + effects::ParameterKey(nonlinear.front(), trace.corrected.kind) + " " +
         Short(term.nonlinear.front().value) + ")";
}

std::string VerdictWord(trace::Verdict verdict) {
  switch (verdict) {
    case trace::Verdict::kEffect:
      return "effect";
    case trace::Verdict::kUnexplained:
      return "unexplained";
    case trace::Verdict::kNone:
      break;
  }
  return "none";
}

std::string VerdictSentence(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = TorqueUnit(trace.corrected.kind);
  switch (trace.verdict) {
    case trace::Verdict::kEffect: {
      std::vector<std::string> names;
      bool in_motion = false;
      for (const trace::FoundEffect& effect : trace.effects) {
        names.push_back(EffectLabel(trace, effect));
        in_motion = in_motion || effect.balance == effects::Balance::kMotion;
      }
      std::vector<std::string> falls;
      const auto fall = [&](const identify::ModelError& before, const identify::ModelError& after,
                            const std::string& what) {
        falls.push_back("from " + Short(before.rms) + " to " + Short(after.rms) + " " + what +
                        " rms");
      };
      if (in_motion) fall(trace.before_sealed, trace.after_sealed, unit);
      for (const trace::BalanceSummary& summary : trace.balances) {
        if (summary.verdict != trace::Verdict::kEffect) continue;
        fall(summary.before_sealed, summary.after_sealed,
             summary.unit + " of the " + std::string(effects::BalanceName(summary.balance)) +
                 " balance");
      }
      std::string out = "The recordings are consistent with " + Join(names, " and ") +
                        ": on the sealed recording the error goes " + Join(falls, " and ") + ".";
      for (const trace::FoundEffect& effect : trace.effects) {
        if (effect.rivals.empty()) continue;
        out += " " + Join(effect.rivals, " and ") +
               (effect.rivals.size() == 1 ? " predicts" : " predict") + " the same here as " +
               effect.name + ".";
      }
      std::vector<std::string> open;
      for (const trace::FoundEffect& effect : trace.effects) {
        if (effect.confirmation.verdict != trace::ConfirmationVerdict::kConfirmed) {
          open.push_back(effect.name);
        }
      }
      if (!open.empty()) {
        out += " The sealed recording does not confirm " + Join(open, " and ") + ".";
      }
      if (trace.effects.front().weak_evidence) {
        out += " This is weak evidence: the recording falls into fewer than six independent parts.";
      }
      return out;
    }
    case trace::Verdict::kUnexplained:
      return "Something follows " + trace.unexplained.variable +
             (trace.unexplained.order_per_turn > 0.0
                  ? " with order " + Short(trace.unexplained.order_per_turn) + " per turn"
                  : "") +
             " (" + Short(trace.unexplained.rms) + " " +
             std::string(effects::BalanceUnit(trace.unexplained.balance, trace.corrected.kind)) +
             " rms), and no effect of the catalogue explains it.";
    case trace::Verdict::kNone:
      break;
  }
  return "No effect beyond the declared model can be shown: the refitted model leaves " +
         Short(trace.before_sealed.rms) + " " + unit + " rms on the sealed recording" +
         (trace.noise_floor_rms > 0.0
              ? ", the noise floor is " + Short(trace.noise_floor_rms) + " " + unit + "."
              : ".");
}

std::string NextExperiment(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  for (const trace::FoundEffect& effect : trace.effects) {
    if (effect.rivals.empty()) continue;
    return "To tell " + effect.name + " from " + Join(effect.rivals, " and ") + ": " +
           effects::MakeEffect(effect.name, {}, effect.balance)->info().separating_excitation + ".";
  }
  for (const trace::ParameterShift& shift : trace.shifts) {
    if (shift.causes.empty() || !trace.effects.empty()) continue;
    return "To tell why " + shift.effect + "." + shift.parameter + " is not what was declared (" +
           Join(shift.causes, " or ") +
           "): " + effects::MakeEffect(shift.causes.front(), {})->info().separating_excitation +
           ".";
  }
  if (trace.verdict == trace::Verdict::kUnexplained) {
    return "Move " + trace.unexplained.variable +
           " alone, slowly, over its whole range, in both directions.";
  }
  // What could hide here, and what would show it: the first that is no matter of declared terms.
  for (const trace::NotExcited& hidden : trace.not_excited) {
    const std::string how = effects::MakeEffect(hidden.effect, {})->info().separating_excitation;
    if (hidden.reason.starts_with("up to") && !how.empty()) {
      return "To see whether there is " + hidden.effect + ": " + how + ".";
    }
  }
  return "";
}

}  // namespace sinew::report
