#include "components/model/report/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "components/model/report/errors.h"
#include "components/model/report/section.h"

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

std::string TorqueUnit(types::JointKind kind) {
  return kind == types::JointKind::kRotary ? "Nm" : "N";
}

std::string EffectTitle(const std::string& name) {
  return effects::MakeEffect(name, {})->info().title;
}

bool HasCorrection(const trace::TraceResult& trace) {
  return std::any_of(trace.effects.begin(), trace.effects.end(),
                     [](const trace::FoundEffect& effect) { return effect.in_model(); });
}

actuator::Term FittedTerm(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  if (!effect.fitted.empty()) return effect.fitted.front();
  return actuator::PhysicalTerm(trace.corrected, effect.term);
}

std::string EffectLabel(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  int alike = 0;
  for (const trace::FoundEffect& other : trace.effects) alike += other.name == effect.name ? 1 : 0;
  const actuator::Term term = FittedTerm(trace, effect);
  const auto& nonlinear = term.effect->info().nonlinear;
  if (alike < 2 || nonlinear.empty()) return effect.name;
  return effect.name + " (" + effects::ParameterKey(nonlinear.front(), trace.corrected.kind) + " " +
         Short(term.nonlinear.front().value) + ")";
}

std::string NamedSetText(const trace::FoundEffect& effect) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < trace::NamedCount(effect.posterior); ++k) {
    const auto& [name, probability] = effect.posterior[k];
    names.push_back(name + " (" + std::to_string(std::lround(100.0 * probability)) + " %)");
  }
  return Join(names, " or ");
}

std::string VerdictWord(trace::Verdict verdict) {
  switch (verdict) {
    case trace::Verdict::kEffect:
      return "effect";
    case trace::Verdict::kUnexplained:
      return "unexplained";
    case trace::Verdict::kTooLittleData:
      return "too_little_data";
    case trace::Verdict::kNone:
      break;
  }
  return "none";
}

namespace {

// The verdict, without the errors that the model raises.
std::string Found(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = TorqueUnit(trace.corrected.kind);
  switch (trace.verdict) {
    case trace::Verdict::kEffect: {
      std::vector<std::string> names, left_out;
      for (const trace::FoundEffect& effect : trace.effects) {
        (effect.in_model() ? names : left_out).push_back(EffectLabel(trace, effect));
      }
      std::vector<std::string> errors;
      for (const ErrorLine& line : ErrorTable(report)) {
        const bool here = std::any_of(trace.effects.begin(), trace.effects.end(),
                                      [&](const trace::FoundEffect& effect) {
                                        return effect.in_model() && effect.balance == line.balance;
                                      });
        if (here && line.key == "held_out") errors.push_back(line.what + ": " + ThreeErrors(line));
      }
      std::string out;
      if (!names.empty()) {
        out = "The recordings are consistent with " + Join(names, " and ") + ". Error on the " +
              Join(errors, "; on the ") + ".";
      }
      if (!left_out.empty()) {
        out += (names.empty() ? "The training recordings support " : " They also support ") +
               Join(left_out, " and ") +
               ", which the held-out recording neither confirms nor refutes; " +
               (left_out.size() == 1 ? "it is" : "they are") + " not in the model.";
      }
      for (const trace::FoundEffect& effect : trace.effects) {
        if (!effect.rivals().empty()) out += " Probability: " + NamedSetText(effect) + ".";
      }
      std::vector<std::string> open;
      for (const trace::FoundEffect& effect : trace.effects) {
        if (effect.in_model() &&
            effect.confirmation.verdict != trace::ConfirmationVerdict::kConfirmed) {
          open.push_back(effect.name);
        }
      }
      if (!open.empty()) {
        out += " The held-out recording does not confirm " + Join(open, " and ") + ".";
      }
      if (trace.effects.front().weak_evidence) {
        out += " The evidence is weak: the recording has fewer than six independent blocks.";
      }
      return out;
    }
    case trace::Verdict::kUnexplained:
      return "Part of the residual follows " + trace.unexplained.variable +
             (trace.unexplained.order_per_turn > 0.0
                  ? " with order " + Short(trace.unexplained.order_per_turn) + " per turn"
                  : "") +
             " (" + Short(trace.unexplained.rms) + " " +
             std::string(effects::BalanceUnit(trace.unexplained.balance, trace.corrected.kind)) +
             " rms), and " +
             (report.given ? "the given effects do not explain it."
                           : "no effect of the catalogue explains it.");
    case trace::Verdict::kTooLittleData:
      return "Too little data for a result: " + trace.too_little->reason + ". Nothing was fitted.";
    case trace::Verdict::kNone:
      break;
  }
  return (report.given ? "The refitted model leaves "
                       : "No effect beyond the declared model is detectable: the refitted model "
                         "leaves ") +
         Short(trace.before_held_out.rms) + " " + unit + " rms on the held-out recordings" +
         (trace.noise_floor_rms > 0.0
              ? ", the noise floor is " + Short(trace.noise_floor_rms) + " " + unit + "."
              : ".");
}

// The given effects, and those of them whose size the recordings do not determine.
std::string GivenSentence(const std::set<std::string>& given, const trace::TraceResult& trace) {
  std::vector<std::string> names(given.begin(), given.end()), open;
  for (const std::string& name : names) {
    const bool fitted =
        std::any_of(trace.effects.begin(), trace.effects.end(),
                    [&](const trace::FoundEffect& effect) { return effect.name == name; });
    if (!fitted) open.push_back(name);
  }
  std::string out =
      "Given, not searched for: " + (names.empty() ? "no effect" : Join(names, " and ")) + ". ";
  if (!open.empty())
    out += "These recordings do not determine a size of " + Join(open, " and ") + ". ";
  return out;
}

}  // namespace

std::string VerdictSentence(const Report& report) {
  if (report.trace.too_little) return Found(report);
  std::string out = RiseSentence(report);
  if (!out.empty()) out += " ";
  if (report.given) out += GivenSentence(*report.given, report.trace);
  return out + Found(report);
}

std::string RotationText(const trace::Rotation& rotation) {
  std::vector<std::string> out;
  for (const auto* list : {&rotation.trace.effects, &rotation.trace.refuted}) {
    for (const trace::FoundEffect& effect : *list) {
      out.push_back(effect.name + " (" +
                    std::string(trace::ConfirmationWord(effect.confirmation.verdict)) + ")");
    }
  }
  return out.empty() ? VerdictWord(rotation.trace.verdict) : Join(out, ", ");
}

std::string NextExperiment(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  if (trace.too_little) {
    return "Record the joint moving for longer: both directions, several speeds, over its range, "
           "in "
           "one recording to train on and another one to hold out.";
  }
  for (const trace::FoundEffect& effect : trace.effects) {
    if (effect.rivals().empty()) continue;
    return "To distinguish " + effect.name + " from " + Join(effect.rivals(), " and ") + ": " +
           effects::MakeEffect(effect.name, {}, effect.balance)->info().separating_excitation + ".";
  }
  for (const trace::ParameterShift& shift : trace.shifts) {
    if (shift.causes.empty() || !trace.effects.empty()) continue;
    return "To find why " + shift.effect + "." + shift.parameter +
           " differs from its declared value (" + Join(shift.causes, " or ") +
           "): " + effects::MakeEffect(shift.causes.front(), {})->info().separating_excitation +
           ".";
  }
  if (trace.verdict == trace::Verdict::kUnexplained) {
    return "Move " + trace.unexplained.variable +
           " alone, slowly, over its whole range, in both directions.";
  }
  // The first effect that is not excited and is not absorbed by declared terms, with the motion
  // that excites it.
  for (const trace::NotExcited& hidden : trace.not_excited) {
    const std::string how = effects::MakeEffect(hidden.effect, {})->info().separating_excitation;
    if (hidden.reason.starts_with("up to") && !how.empty()) {
      return "To make " + hidden.effect + " detectable" + ": " + how + ".";
    }
  }
  return "";
}

}  // namespace sinew::report
