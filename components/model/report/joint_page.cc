#include "components/base/types/joined.h"
#include "components/base/types/seconds.h"
#include "components/model/report/errors.h"
#include "components/model/report/page_parts.h"
#include "components/model/report/report.h"
#include "components/model/trace/rules.h"

namespace sinew::report {

namespace {

std::string Probability(double p) { return Text(p < 1e-3 ? "%.0e" : "%.3f", p); }

std::string GlobalP(const trace::TraceResult& trace) {
  return trace.p_global ? Probability(*trace.p_global) : "unknown";
}

Section EffectSection(const trace::TraceResult& trace,
                      const std::vector<trace::FoundEffect>& effects, const std::string& title,
                      const std::string& caption) {
  Section out = TableSection(
      title,
      {"effect", "size, 95 %", "removes in training", "held-out recordings",
       "held-out error, without -> with", "probability of the name, if it is one of the catalogue"},
      caption);
  for (const trace::FoundEffect& effect : effects) {
    const std::string why = RefusalText(effect);
    const effects::EffectInfo info = effects::MakeEffect(effect.name, {})->info();
    out.Add({EffectLabel(trace, effect) + "\n" + info.title + "\n" + info.formula,
             SizesText(trace, effect), Percent(effect.gain_share),
             ConfirmedText(effect.confirmation) + (why.empty() ? "" : "\n" + why),
             ErrorText(effect.held_out_before) + " -> " + ErrorText(effect.held_out_after) + " " +
                 ErrorUnit(trace, effect.balance),
             NamedSetText(effect.posterior)});
  }
  return out;
}

Section EventSection(const Report& report) {
  Section out = TableSection("Events", {"event", "recording", "began, s after its start"});
  for (const trace::EventTime& event : report.trace.events) {
    double after_s = event.start_s;
    for (const Recording& recording : event.held_out ? report.held_out : report.train) {
      if (recording.name == event.recording) after_s = event.start_s - recording.start_s;
    }
    out.Add({event.effect, event.recording + (event.held_out ? " (held out)" : ""),
             types::SecondsText(after_s)});
  }
  return out;
}

std::string DivergedText(const free_run::FreeRun& run) {
  const auto pieces = [&](std::size_t model) {
    return std::to_string(run.models.at(model).diverged);
  };
  const auto diverged = [](const free_run::ModelError& model) { return model.diverged > 0; };
  if (std::none_of(run.models.begin(), run.models.end(), diverged)) return "";
  return " Of " + std::to_string(run.models[0].pieces) + " simulated pieces " +
         pieces(kDeclaredModel) + ", " + pieces(kRefittedModel) + " and " +
         pieces(kCorrectedModel) +
         " diverged; they are excluded for all models, and a model that loses more than half of "
         "them has no error.";
}

Section ErrorSection(const Report& report) {
  Section out = TableSection("Errors", {"rms", "declared", "refitted", "corrected", "unit"});
  for (const ErrorLine& line : ErrorTable(report)) {
    out.Add({line.what, ErrorText(line.declared), ErrorText(line.refitted),
             ErrorText(line.corrected), line.unit});
  }
  const trace::TraceResult& trace = report.trace;
  const auto drive = [&](const char* what, const identify::ModelError& declared,
                         const identify::ModelError& refitted,
                         const identify::ModelError& corrected) {
    out.Add({what, Short(declared.percent), Short(refitted.percent), Short(corrected.percent),
             "% of " + MeasuredSide(trace)});
  };
  drive("training recordings", trace.nominal_train, trace.before_train, trace.after_train);
  drive("held-out recordings", trace.nominal_held_out, trace.before_held_out, trace.after_held_out);
  out.tables[0].caption =
      "Declared: the model file as it is. Refitted: its parameters fitted to the training "
      "recordings. Corrected: with the effects that are in the model." +
      (report.free_run.errors ? DivergedText(*report.free_run.errors)
                              : " Not simulated: " + report.free_run.why_not + ".");
  for (const trace::BalanceSummary& summary : trace.balances) {
    if (summary.unseen.empty()) continue;
    out.paragraphs.push_back(std::string(effects::BalanceName(summary.balance)) +
                             " balance: " + summary.unseen);
  }
  return out;
}

Section RotationSection(const Report& report) {
  Section out = TableSection(
      "Each recording held out once",
      {"held out", "found in the others", "declared", "refitted", "corrected", "unit"},
      "An effect is part of the model when it is confirmed in all rotations but one, in two at "
      "least, and refuted in none; the model is then fitted to all recordings. Held-out errors of "
      "this page are those of the rotations.");
  for (const trace::Rotation& rotation : report.rotations) {
    const trace::TraceResult& trace = rotation.trace;
    out.Add({rotation.held_out, RotationText(rotation), Short(trace.nominal_held_out.rms),
             Short(trace.before_held_out.rms), Short(trace.after_held_out.rms),
             ErrorUnit(report.trace)});
  }
  return out;
}

Section ParameterSection(const trace::TraceResult& trace) {
  Section out = TableSection(
      "Parameters", {"parameter", "declared", "refitted", "corrected", "+- 95 %"}, "", true);
  const types::JointKind kind = trace.corrected.kind;
  for (std::size_t t = 0; t < trace.corrected.terms.size(); ++t) {
    const auto term_of = [&](const actuator::JointModel& model) {
      return actuator::PhysicalTerm(model, static_cast<int>(t));
    };
    const actuator::Term term = term_of(trace.corrected);
    const effects::EffectInfo& info = term.effect->info();
    const auto add = [&](const std::vector<effects::ParameterInfo>& parameters,
                         std::vector<actuator::ParameterValue> actuator::Term::*values) {
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        const actuator::ParameterValue& value = (term.*values)[k];
        std::vector<std::string> row = {info.name + "." +
                                        effects::ParameterKey(parameters[k], kind)};
        for (const actuator::JointModel* model : {&trace.nominal, &trace.declared}) {
          const bool was = t < trace.declared.terms.size() && term.declared;
          row.push_back(was ? Short((term_of(*model).*values)[k].value) : "");
        }
        row.push_back(Short(value.value));
        row.push_back(value.half_width_95 ? Short(*value.half_width_95)
                      : value.fixed       ? "known"
                                          : "");
        out.Add(std::move(row));
      }
    };
    add(info.linear, &actuator::Term::linear);
    add(info.nonlinear, &actuator::Term::nonlinear);
  }
  return out;
}

Section ShiftSection(const trace::TraceResult& trace) {
  Section out =
      TableSection("Absorbed by refitting",
                   {"parameter", "declared", "refitted", "tolerance", "sigma",
                    "causes that share the direction"},
                   "Declared parameters that moved by more than their tolerance, and effects that "
                   "would move them in the same way.");
  for (const trace::ParameterShift& shift : trace.shifts) {
    out.Add({shift.effect + "." + shift.parameter, Short(shift.nominal), Short(shift.refit),
             Short(shift.tolerance), Short(shift.sigma),
             shift.causes.empty() ? "none known" : types::Joined(shift.causes)});
  }
  return out;
}

Section PublishedSection(const Report& report) {
  Section out =
      TableSection("With the publication's own processing",
                   {"relative error of the drive", "declared model, %", "with the effect, %"});
  if (!report.as_published) return out;
  const identify::AsPublishedResult& published = *report.as_published;
  out.Add({"training recording", Short(published.before_percent), Short(published.after_percent)});
  out.Add({"cross test on the held-out recording", Short(published.cross_before_percent),
           Short(published.cross_after_percent)});
  return out;
}

// The smallest sizes that would have been found, a row for each parameter.
Section DetectableSection(const trace::TraceResult& trace) {
  namespace rules = trace::rules;
  Section out = TableSection(
      "Smallest detectable sizes",
      {"effect", "parameter", "smallest detectable size", "share of the measured side"},
      "The smallest size of each effect that this search finds in 80 % of recordings like these, "
      "with the effect alone and at its most visible shape: p of the whole search at most " +
          Short(trace.in_force.Limit(rules::kGlobalP)) + " (rule p_global) and at least " +
          Percent(trace.in_force.Limit(rules::kExplainedShare)) +
          " of the refitted model's misfit (rule explained_share; effects identified from "
          "accelerations or rates: " +
          Percent(trace.in_force.Limit(rules::kCurveShare)) +
          ", rule curve_share). Smaller effects may be present. Not listed: effects absorbed by "
          "refitting the declared terms (see the shift of parameters), and spectral lines and "
          "events, which have no size before they are found.",
      true);
  for (const trace::DetectableSize& size : trace.detectable) {
    std::string effect = size.effect;
    for (const auto& [key, value] : size.shape) effect += "\n" + key + " = " + Short(value);
    out.Add({effect, size.parameter, Text("%.2g", size.size), Text("%.2g %%", 100.0 * size.share)});
  }
  return out;
}

Section UnexplainedSection(const trace::TraceResult& trace) {
  const trace::Unexplained& left = trace.unexplained;
  Section out = {.title = "What the model leaves unexplained", .detail = true};
  if (left.variable.empty()) {
    out.paragraphs = {"No part of the residual follows a single measured variable."};
    return out;
  }
  out.paragraphs = {
      left.variable +
      (left.order_per_turn > 0.0 ? ", order " + Short(left.order_per_turn) + " per turn" : "") +
      " predicts another " + Percent(left.share) + " of the residual (" + Short(left.rms) + " " +
      ErrorUnit(trace) + " rms)."};
  return out;
}

// Training rows that are used, why not the others, and at which speeds.
std::string RowsText(const trace::TraceResult& trace) {
  std::string out = std::to_string(trace.used_rows) + " of " + std::to_string(trace.rows) +
                    " training rows are used";
  const char* separator = "; not used: ";
  for (const auto& [reason, rows] : trace.row_usage.not_used) {
    out += separator + reason + " " + std::to_string(rows);
    separator = ", ";
  }
  double from = 0.0;
  const std::string unit = trace.corrected.kind == types::JointKind::kRevolute ? "rad/s" : "m/s";
  separator = "; used by speed: ";
  for (const trace::RowUsage::Speed& speed : trace.row_usage.by_speed) {
    if (speed.rows > 0) {
      out += separator + Short(from) + " to " + Short(speed.up_to) + " " + unit + " " +
             Percent(static_cast<double>(speed.used) / static_cast<double>(speed.rows)) + " of " +
             std::to_string(speed.rows);
      separator = ", ";
    }
    from = speed.up_to;
  }
  return out;
}

Section MethodSection(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  return {
      .title = "Method",
      .paragraphs =
          {"Zero-phase filters: states " + Short(report.processing.state_cutoff_Hz) + " Hz" +
           (trace.by_simulation ? "; fits by simulation, the start state of every piece free"
                                : ", both sides of the balance " +
                                      Short(report.processing.parallel_cutoff_Hz) + " Hz") +
           ". Sets of effects and free curves compared by whitened likelihood; p of the whole "
           "search " +
           GlobalP(trace) + " by sign flips of " + std::to_string(trace.blocks) + " blocks of " +
           Short(trace.block_length_s) + " s, seed " + std::to_string(report.seed) +
           "; the selected set is confirmed by the slope of the held-out residual on the predicted "
           "change. report.json names the rule that rejected each candidate, with its number. What "
           "is found depends on what was declared: a wrong value with a narrow tolerance is found "
           "as an effect that makes up for it, and a wide tolerance may hide one."},
      .detail = true};
}

Section TooLittleSection(const trace::TooLittle& too_little) {
  Section out = TableSection("Too little data", {"rule", "here", "limit"});
  out.Add({too_little.rule, Short(too_little.statistic), Short(too_little.limit)});
  return out;
}

void AddFigures(const Report& report, Page* page) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = " " + ErrorUnit(trace);
  page->figures = {{Short(trace.after_held_out.rms) + unit,
                    "error of the corrected model on the held-out recordings (" +
                        Short(trace.before_held_out.rms) + " refitted, " +
                        Short(trace.nominal_held_out.rms) + " declared)"},
                   {trace.noise_floor_rms > 0.0 ? Short(trace.noise_floor_rms) + unit : "unknown",
                    "noise of the sensors" +
                        (trace.noise_floor_source.empty() ? "" : ", " + trace.noise_floor_source)},
                   {Short(trace.ceiling_rms) + unit,
                    "residual of the richest model: all effects, curves and lines together"}};
}

}  // namespace

Page MakePage(const Report& report, std::vector<Picture> pictures) {
  if (report.gate.stops()) return MakeCheckPage(report, std::move(pictures));
  const trace::TraceResult& trace = report.trace;
  Page page = {.title = "Closing the loop: " + report.robot + ", " + report.joint,
               .meta = MetaText(report.train, report.held_out, report.model_file),
               .verdict = VerdictWord(report),
               .outcome = OutcomeWord(report),
               .sentence = VerdictSentence(report)};
  const Section next = NextSection(NextExperiment(report));
  const Section faults = FaultSection(report.gate);
  Section data = DataSection(report.gate);
  if (trace.too_little) {
    page.sections = {next, TooLittleSection(*trace.too_little), faults,
                     RecordingsSection(report.train, report.held_out), data};
    return page;
  }
  AddFigures(report, &page);
  if (trace.rows > 0) data.paragraphs = {RowsText(trace)};
  page.sections = {
      EffectSection(trace, trace.effects, "Effects found",
                    "p of the whole search: " + GlobalP(trace) +
                        ". In the model, the one that training misses most first. Simulation, "
                        "controllers and sinew-residual load model.yaml as it is; sinew verify "
                        "simulates it and the declared model beside a recording."),
      EventSection(report),
      next,
      ErrorSection(report),
      EffectSection(trace, trace.open, "Open",
                    "Supported by the training recordings, but too little speaks for the names. "
                    "Not in the model."),
      EffectSection(trace, trace.refuted, "Refuted on the held-out recordings",
                    "Selected on the training recordings, but the held-out error rises with the "
                    "effect, or the drive could not have driven the motion with it, or too little "
                    "speaks for what a second search finds. Not in the model."),
      RotationSection(report),
      {.pictures = std::move(pictures)},
      ParameterSection(trace),
      ShiftSection(trace),
      PublishedSection(report),
      NotExcitedSection(trace.not_excited),
      DetectableSection(trace),
      UnexplainedSection(trace),
      faults,
      data,
      RecordingsSection(report.train, report.held_out),
      MethodSection(report)};
  return page;
}

}  // namespace sinew::report
