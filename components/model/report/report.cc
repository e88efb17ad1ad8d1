#include "components/model/report/report.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/joined.h"
#include "components/model/report/errors.h"
#include "components/model/trace/rules.h"

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
  return kind == types::JointKind::kRevolute ? "Nm" : "N";
}

std::string ErrorUnit(const trace::TraceResult& trace, effects::Balance balance) {
  const types::JointKind kind = trace.corrected.kind;
  if (!trace.by_simulation) return std::string(effects::BalanceUnit(balance, kind));
  return kind == types::JointKind::kRevolute ? "rad" : "m";
}

std::string MeasuredSide(const trace::TraceResult& trace) {
  return trace.by_simulation ? "the motion" : "the drive";
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

std::string NamedSetText(const trace::Posterior& posterior) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < trace::NamedCount(posterior); ++k) {
    const auto& [name, probability] = posterior[k];
    names.push_back(name + " (" + std::to_string(std::lround(100.0 * probability)) + " %)");
  }
  return Join(names, " or ");
}

std::string VerdictWord(const Report& report) {
  return report.gate.stops() ? VerdictWord(report.gate) : VerdictWord(report.trace.verdict);
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

std::string SizesText(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  const actuator::Term term = FittedTerm(trace, effect);
  const effects::EffectInfo& info = term.effect->info();
  std::vector<std::string> out;
  for (std::size_t i = 0; i < info.linear.size(); ++i) {
    const actuator::ParameterValue& value = term.linear[i];
    if (value.value == 0.0 && value.half_width_95 == 0.0) continue;  // no payload: no part of it
    out.push_back(effects::ParameterKey(info.linear[i], trace.corrected.kind) + " = " +
                  Short(value.value) +
                  (value.half_width_95 ? " +- " + Short(*value.half_width_95) : ""));
  }
  for (std::size_t i = 0; i < info.nonlinear.size(); ++i) {
    std::string values = Short(term.nonlinear[i].value);
    // Other orders of the same effect.
    for (std::size_t t = 1; t < effect.fitted.size(); ++t) {
      values += ", " + Short(effect.fitted[t].nonlinear[i].value);
    }
    out.push_back(effects::ParameterKey(info.nonlinear[i], trace.corrected.kind) + " = " + values);
  }
  return types::Joined(out);
}

std::string HeldOutText(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  std::string out = "held-out error " + ErrorText(effect.held_out_before) + " -> " +
                    ErrorText(effect.held_out_after) + " " + ErrorUnit(trace, effect.balance);
  if (!(effect.held_out_before > 0.0) || !std::isfinite(effect.held_out_after)) return out;
  out += Text(" (%+.1f %%)", 100.0 * (effect.held_out_after / effect.held_out_before - 1.0));
  for (const trace::ZeroTurn& turn : trace.zero_turns) {
    if (turn.effect != effect.name) continue;
    out += Text(", the zero of the motor's angle turned by %.2f rad in ", turn.turn_rad) +
           turn.recording;
  }
  return out;
}

std::string RefusalText(const trace::FoundEffect& effect) {
  namespace rules = trace::rules;
  const trace::Refusal& refusal = effect.refusal;
  const trace::Confirmation& there = effect.confirmation;
  if (refusal.rule.empty()) return "";
  std::string out;
  if (refusal.rule == rules::kScore.id) {
    out = !(there.upper > there.lower)
              ? "its size does not show"
              : "its size there is " + Short(there.slope) + " times the trained one, [" +
                    Short(there.lower) + ", " + Short(there.upper) + "]";
    constexpr double kCurveWorthWords = 0.1;  // of a score of one half it takes 0.06
    if (effect.curve > kCurveWorthWords) {
      out += Text("; a free curve beside it explains %.0f %% as much", 100.0 * effect.curve);
    }
  } else if (refusal.rule == rules::kRaises.id) {
    out = Text("the held-out error rises by %.1f %%", 100.0 * (refusal.value - 1.0));
  } else if (refusal.rule == rules::kBeyondDrive.id) {
    out = "the drive could not have driven this motion with it";
  } else if (refusal.rule == rules::kRotations.id) {
    out = "too few rotations confirm it";
  }
  return out + (out.empty() ? "" : "; ") + "rule " + refusal.rule + ": " + Short(refusal.value) +
         ", limit " + Short(refusal.limit);
}

std::string OutcomeWord(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  if (report.gate.stops()) return VerdictWord(report);
  if (trace.verdict == trace::Verdict::kUnexplained) {
    return !trace.unexplained.variable.empty() ? "unexplained"
           : !trace.open.empty()               ? "open"
                                               : "training_only";
  }
  if (trace.verdict == trace::Verdict::kNone) {
    return trace::NearNoise(trace) ? "nothing" : "not_detectable";
  }
  return VerdictWord(trace.verdict);
}

namespace {

// Effects of the model: what, how much, and what each does to the held-out error.
std::string EffectSentences(const trace::TraceResult& trace) {
  std::string out;
  std::vector<std::string> unconfirmed;
  for (const trace::FoundEffect& effect : trace.effects) {
    out += (out.empty() ? "" : " ") + EffectLabel(trace, effect) + " (" + EffectTitle(effect.name) +
           "): " + SizesText(trace, effect) + "; " + HeldOutText(trace, effect) + ".";
    if (effect.confirmation.verdict != trace::ConfirmationVerdict::kConfirmed) {
      unconfirmed.push_back(effect.name);
    }
  }
  if (!unconfirmed.empty()) {
    out += " The held-out recordings do not confirm " + Join(unconfirmed, " and ") + ".";
  }
  return out;
}

std::string OpenSentences(const trace::TraceResult& trace) {
  std::string out;
  for (const trace::FoundEffect& effect : trace.open) {
    out += (out.empty() ? "" : " ") + std::string("Open, and not in the model: ") +
           EffectLabel(trace, effect) + " (" + EffectTitle(effect.name) + "), " +
           SizesText(trace, effect) +
           "; the training recordings support it, but too little speaks for its name (held out " +
           RefusalText(effect) + ").";
  }
  return out;
}

std::string TrainingOnlySentences(const trace::TraceResult& trace) {
  std::string out = "Found in training, not in the held-out recordings:";
  for (const trace::FoundEffect& effect : trace.refuted) {
    out += " " + effect.name + " takes " + Text("%.0f %%", 100.0 * effect.gain_share) +
           " of the training misfit, but held out " + RefusalText(effect) + ".";
  }
  return out +
         " Usual reasons: the angle's zero moved between the recordings (an encoder without an "
         "absolute zero, restarted), the load did, or the held-out motion has another range.";
}

std::string UnexplainedSentence(const Report& report) {
  const trace::Unexplained& unexplained = report.trace.unexplained;
  return "Part of the residual follows " + unexplained.variable +
         (unexplained.order_per_turn > 0.0
              ? " with order " + Short(unexplained.order_per_turn) + " per turn"
              : "") +
         " (" + Short(unexplained.rms) + " " + ErrorUnit(report.trace, unexplained.balance) +
         " rms), and " +
         (report.given ? "the given effects do not explain it."
                       : "no effect of the catalogue explains it.");
}

std::string NothingSentence(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = " " + ErrorUnit(trace);
  const std::string noise = Short(trace.noise_floor_rms) + unit;
  const std::string leaves =
      "the refitted model leaves " + Short(trace.before_held_out.rms) + unit +
      " rms on the held-out recordings" +
      (trace.before_held_out.percent > 0.0
           ? ", " + Short(trace.before_held_out.percent) + " % of " + MeasuredSide(trace)
           : "");
  if (trace::NearNoise(trace)) {
    return "Nothing beyond the noise: " + leaves + "; the noise of the sensors alone is " + noise +
           ".";
  }
  const std::string still =
      leaves + (trace.noise_floor_rms > 0.0 ? "; the noise of the sensors is " + noise + "." : ".");
  if (report.given) return std::string("T") + still.substr(1);
  const bool something =
      trace.p_global && *trace.p_global <= trace.in_force.Limit(trace::rules::kGlobalP);
  return (something ? "No effect explains enough of the residual to be named: "
                    : "No effect beyond the declared model is detectable: ") +
         still;
}

// The verdict, without the errors that the model raises.
std::string Found(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  if (trace.too_little) {
    return "Too little data for a result: " + trace.too_little->reason + ". Nothing was fitted.";
  }
  std::vector<std::string> out;
  if (!trace.effects.empty()) out.push_back(EffectSentences(trace));
  if (!trace.unexplained.variable.empty()) out.push_back(UnexplainedSentence(report));
  if (!trace.open.empty()) out.push_back(OpenSentences(trace));
  if (out.empty() && !trace.refuted.empty() && trace.verdict == trace::Verdict::kUnexplained) {
    out.push_back(TrainingOnlySentences(trace));
  }
  if (out.empty()) out.push_back(NothingSentence(report));
  std::string text;
  for (const std::string& sentence : out) text += (text.empty() ? "" : " ") + sentence;
  return text;
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
  if (report.gate.stops()) return VerdictSentence(report.gate);
  if (report.trace.too_little) return Found(report);
  std::string out;
  if (report.given) out = GivenSentence(*report.given, report.trace);
  out += Found(report);
  const std::string rises = RiseSentence(report);
  return rises.empty() ? out : out + " " + rises;
}

std::string RotationText(const trace::Rotation& rotation) {
  std::vector<std::string> out;
  for (const auto* list :
       {&rotation.trace.effects, &rotation.trace.open, &rotation.trace.refuted}) {
    for (const trace::FoundEffect& effect : *list) {
      out.push_back(effect.name + " (" +
                    std::string(trace::ConfirmationWord(effect.confirmation.verdict)) + ")");
    }
  }
  return out.empty() ? VerdictWord(rotation.trace.verdict) : Join(out, ", ");
}

std::string NextExperiment(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  if (report.gate.stops()) return "";
  if (trace.too_little) {
    return "Record the joint moving for longer: both directions, several speeds, over its range, "
           "in "
           "one recording to train on and another one to hold out.";
  }
  const auto separating = [](const trace::FoundEffect& effect) {
    return effects::MakeEffect(effect.name, {}, effect.balance)->info().separating_excitation + ".";
  };
  for (const trace::FoundEffect& effect : trace.effects) {
    if (effect.rivals().empty()) continue;
    return "To distinguish " + effect.name + " from " + Join(effect.rivals(), " and ") + ": " +
           separating(effect);
  }
  for (const trace::FoundEffect& effect : trace.open) {
    return "To confirm or refute " + effect.name +
           ": hold out a recording with this motion: " + separating(effect);
  }
  if (trace.effects.empty() && trace.unexplained.variable.empty() && !trace.refuted.empty()) {
    return "Repeat the held-out recording right after a training one, without a restart and with "
           "the "
           "same load and range: " +
           trace.refuted.front().name + " is then confirmed, or is none.";
  }
  for (const trace::ParameterShift& shift : trace.shifts) {
    if (shift.causes.empty() || !trace.effects.empty()) continue;
    return "To find why " + shift.effect + "." + shift.parameter +
           " differs from its declared value (" + Join(shift.causes, " or ") +
           "): " + effects::MakeEffect(shift.causes.front(), {})->info().separating_excitation +
           ".";
  }
  if (!trace.unexplained.variable.empty()) {
    if (trace.unexplained.variable == "time_s") {
      return "Something changes that the recordings do not hold (another axis, a temperature, a "
             "load): record it, or repeat the same motion several times.";
    }
    return "Move " + trace.unexplained.variable +
           " alone, slowly, over its whole range, in both directions.";
  }
  if (!trace.effects.empty()) return "";
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
