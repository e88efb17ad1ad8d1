#include <cstdio>

#include "components/base/types/joined.h"
#include "components/model/report/errors.h"
#include "components/model/report/gate_page.h"
#include "components/model/report/report.h"
#include "components/model/report/section.h"
#include "components/model/trace/rules.h"

namespace sinew::report {

namespace {

std::string Percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", 100.0 * share);
  return text;
}

std::string Probability(double p) {
  char text[32];
  std::snprintf(text, sizeof text, p < 1e-3 ? "%.0e" : "%.3f", p);
  return text;
}

// The result on the held-out recordings: word, slope and its interval.
std::string Confirmed(const trace::Confirmation& confirmation) {
  if (confirmation.blocks == 0) return "not tested";
  return std::string(trace::ConfirmationWord(confirmation.verdict)) + "<br>slope " +
         Short(confirmation.slope) + "<br>[" + Short(confirmation.lower) + ", " +
         Short(confirmation.upper) + "]";
}

std::string HeldOutErrors(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  return ErrorText(effect.held_out_before) + " &rarr; " + ErrorText(effect.held_out_after) + " " +
         ErrorUnit(trace, effect.balance);
}

// A table of effects; empty without any.
std::string EffectTable(const trace::TraceResult& trace,
                        const std::vector<trace::FoundEffect>& effects, const std::string& title,
                        const std::string& caption) {
  if (effects.empty()) return "";
  std::string out = "<h2>" + title + "</h2>\n<p class=\"caption\">" + caption + "</p>\n<table>" +
                    HtmlRow({"effect", "size, 95 %", "removes in training", "held-out recordings",
                             "held-out error, without &rarr; with",
                             "probability of the name, if it is one of the catalogue"},
                            "th");
  for (const trace::FoundEffect& effect : effects) {
    const std::string why = RefusalText(effect);
    out += HtmlRow({"<code>" + Escape(EffectLabel(trace, effect)) + "</code><br>" +
                        Escape(EffectTitle(effect.name)),
                    Escape(SizesText(trace, effect)), Percent(effect.gain_share),
                    Confirmed(effect.confirmation) + (why.empty() ? "" : "<br>" + Escape(why)),
                    HeldOutErrors(trace, effect), Escape(NamedSetText(effect))});
  }
  return out + "</table>\n";
}

std::string Events(const trace::TraceResult& trace) {
  if (trace.events.empty()) return "";
  std::string out = "<table>" + HtmlRow({"event", "recording", "began at, s"}, "th");
  for (const trace::EventTime& event : trace.events) {
    out += HtmlRow({"<code>" + Escape(event.effect) + "</code>",
                    Escape(event.recording) + (event.held_out ? " (held out)" : ""),
                    Short(event.start_s)});
  }
  return out + "</table>\n";
}

std::string Errors(const Report& report) {
  std::string out = "<h2>Errors</h2>\n<table>" +
                    HtmlRow({"rms", "declared", "refitted", "corrected", "unit"}, "th");
  for (const ErrorLine& line : ErrorTable(report)) {
    out += HtmlRow({Escape(line.what), ErrorText(line.declared), ErrorText(line.refitted),
                    ErrorText(line.corrected), line.unit});
  }
  const trace::TraceResult& trace = report.trace;
  const auto drive = [&](const char* what, const identify::ModelError& declared,
                         const identify::ModelError& refitted,
                         const identify::ModelError& corrected) {
    out += HtmlRow({what, Short(declared.percent), Short(refitted.percent),
                    Short(corrected.percent), "% of " + MeasuredSide(trace)});
  };
  drive("training recordings", trace.nominal_train, trace.before_train, trace.after_train);
  drive("held-out recordings", trace.nominal_held_out, trace.before_held_out, trace.after_held_out);
  out +=
      "</table>\n<p class=\"caption\">Declared: the model file as it is. Refitted: its "
      "parameters fitted to the training recordings. Corrected: with the effects that are in "
      "the model.";
  if (report.free_run.errors) {
    const std::vector<free_run::ModelError>& models = report.free_run.errors->models;
    const auto pieces = [&](std::size_t model) {
      return std::to_string(models.at(model).diverged);
    };
    if (models[0].diverged + models[1].diverged + models[2].diverged > 0) {
      out +=
          " Of " + std::to_string(models[0].pieces) + " simulated pieces " +
          pieces(kDeclaredModel) + ", " + pieces(kRefittedModel) + " and " +
          pieces(kCorrectedModel) +
          " diverged; they are excluded for all models, and a model that loses more than half of "
          "them has no error.";
    }
  } else {
    out += " Not simulated: " + Escape(report.free_run.why_not) + ".";
  }
  return out + "</p>\n";
}

std::string Rotations(const Report& report) {
  if (report.rotations.empty()) return "";
  std::string out =
      "<h2>Each recording held out once</h2>\n<p class=\"caption\">An effect is part of the model "
      "when it is confirmed in all rotations but one, in two at least, and refuted in none; the "
      "model is then fitted to all recordings. Held-out errors of this page are those of the "
      "rotations.</p><table>" +
      HtmlRow({"held out", "found in the others", "declared", "refitted", "corrected", "unit"},
              "th");
  for (const trace::Rotation& rotation : report.rotations) {
    out += HtmlRow({Escape(rotation.held_out), Escape(RotationText(rotation)),
                    Short(rotation.trace.nominal_held_out.rms),
                    Short(rotation.trace.before_held_out.rms),
                    Short(rotation.trace.after_held_out.rms), ErrorUnit(report.trace)});
  }
  return out + "</table>\n";
}

// Which training rows are used, why not the others, and at which speeds.
std::string RowsText(const trace::TraceResult& trace) {
  std::string out = std::to_string(trace.used_rows) + " of " + std::to_string(trace.rows) +
                    " training rows are used";
  const trace::RowUsage& usage = trace.row_usage;
  std::string reasons;
  for (const auto& [reason, rows] : usage.not_used) {
    reasons += (reasons.empty() ? "; not used: " : ", ") + reason + " " + std::to_string(rows);
  }
  out += reasons;
  double from = 0.0;
  const std::string unit = trace.corrected.kind == types::JointKind::kRotary ? "rad/s" : "m/s";
  std::string speeds;
  for (const trace::RowUsage::Speed& speed : usage.by_speed) {
    if (speed.rows > 0) {
      speeds += (speeds.empty() ? "; used by speed: " : ", ") + Short(from) + " to " +
                Short(speed.up_to) + " " + unit + " " +
                Percent(static_cast<double>(speed.used) / static_cast<double>(speed.rows)) +
                " of " + std::to_string(speed.rows);
    }
    from = speed.up_to;
  }
  return out + speeds;
}

// The smallest sizes that would have been found, a row for each parameter.
std::string Detectable(const trace::TraceResult& trace) {
  if (trace.detectable.empty()) return "";
  std::string out =
      "<h2>Smallest detectable sizes</h2>\n<p class=\"caption\">The smallest size of each effect "
      "that this search finds in 80 % of recordings like these, with the effect alone and at its "
      "most visible shape: p of the whole search at most " +
      Short(trace::Limit(trace::rules::kGlobalP)) + " (rule p_global) and at least " +
      Percent(trace::Limit(trace::rules::kTorqueShare)) +
      " of the measured side (rule torque_share; in balances other than the torque's " +
      Percent(trace::Limit(trace::rules::kExplainedShare)) +
      " of the refitted model's misfit, rule explained_share). Smaller effects may be present. Not "
      "listed: effects absorbed by refitting the declared terms (see the shift of parameters), and "
      "spectral lines and events, which have no size before they are found.</p><table>" +
      HtmlRow({"effect", "parameter", "smallest detectable size", "share of the measured side"},
              "th");
  for (const trace::DetectableSize& size : trace.detectable) {
    std::string shape;
    for (const auto& [key, value] : size.shape) {
      shape += "<br>" + Escape(key) + " = " + Short(value);
    }
    out += HtmlRow({"<code>" + Escape(size.effect) + "</code>" + shape,
                    "<code>" + Escape(size.parameter) + "</code>", Text("%.2g", size.size),
                    Text("%.2g %%", 100.0 * size.share)});
  }
  return out + "</table>\n";
}

// The method in one sentence.
std::string Method(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  return ". Sets of effects and free curves compared by whitened likelihood; p of the whole "
         "search " +
         (trace.p_global ? Probability(*trace.p_global) : "unknown") + " by sign flips of " +
         std::to_string(trace.blocks) + " blocks of " + Short(trace.block_length_s) + " s, seed " +
         std::to_string(report.seed) +
         "; the selected set is confirmed by the slope of the held-out residual on the predicted "
         "change. report.json names the rule that rejected each candidate, with its number. What "
         "is "
         "found depends on what was declared: a wrong value with a narrow tolerance is found as an "
         "effect that makes up for it, and a wide tolerance may hide one.";
}

}  // namespace

std::string FormatHtml(const Report& report, const std::vector<Picture>& pictures,
                       const std::vector<std::string>& svgs) {
  const trace::TraceResult& trace = report.trace;
  const types::JointKind kind = trace.corrected.kind;
  const std::string unit = ErrorUnit(trace);
  std::string out = HtmlHead("Closing the loop: " + report.robot);
  out += "<h1>Closing the loop: " + Escape(report.robot) + ", " + Escape(trace.corrected.name) +
         "</h1>\n";
  std::vector<std::string> train;
  for (const Recording& recording : report.train) train.push_back(recording.name);
  std::vector<std::string> held_out;
  for (const Recording& recording : report.held_out) held_out.push_back(recording.name);
  out += "<div class=\"meta\">Trained on " + Escape(types::Joined(train)) +
         ". Held out: " + Escape(types::Joined(held_out)) + ". Model " + Escape(report.model_file) +
         ".</div>\n";
  out += "<div class=\"verdict " + OutcomeWord(trace) + "\">" + Escape(VerdictSentence(report)) +
         "</div>\n";
  const std::string next = NextExperiment(report);

  const auto box = [&](const std::string& value, const std::string& text) {
    out += "<div><b>" + value + "</b><span>" + text + "</span></div>\n";
  };
  out += "<div class=\"big\">\n";
  box(Short(trace.after_held_out.rms) + " " + unit,
      "error of the corrected model on the held-out recordings (" +
          Short(trace.before_held_out.rms) + " refitted, " + Short(trace.nominal_held_out.rms) +
          " declared)");
  box(trace.noise_floor_rms > 0.0 ? Short(trace.noise_floor_rms) + " " + unit : "unknown",
      "noise of the sensors" + (trace.noise_floor_source.empty()
                                    ? std::string()
                                    : ", " + Escape(trace.noise_floor_source)));
  box(Short(trace.ceiling_rms) + " " + unit,
      "residual of the richest model: all effects, curves and lines together");
  out += "</div>\n" + Errors(report);

  out += EffectTable(trace, trace.effects, "Effects found",
                     "p of the whole search: " +
                         (trace.p_global ? Probability(*trace.p_global) : std::string("unknown")) +
                         ". In the model, the one that training misses most first.") +
         Events(trace);
  if (!next.empty()) out += "<h2>Next experiment</h2><p>" + Escape(next) + "</p>\n";
  out += EffectTable(trace, trace.open, "Open",
                     "Supported by the training recordings, but too little speaks for the names. "
                     "Not in the model.") +
         EffectTable(trace, trace.refuted, "Refuted on the held-out recordings",
                     "Selected on the training recordings, but the held-out error rises with the "
                     "effect, or the drive could not have driven the motion with it, or too little "
                     "speaks for what a second search finds. Not in the model.") +
         Rotations(report);
  for (std::size_t i = 0; i < pictures.size() && i < svgs.size(); ++i) {
    out += "<figure><h3>" + Escape(pictures[i].title) + "</h3>" + svgs[i] +
           "<p class=\"caption\">" + Escape(pictures[i].caption) + "</p></figure>\n";
  }
  out += "<h2>Parameters</h2>\n<table>" +
         HtmlRow({"parameter", "declared", "refitted", "corrected", "&plusmn; 95 %"}, "th");
  for (std::size_t t = 0; t < trace.corrected.terms.size(); ++t) {
    const auto physical = [&](const actuator::JointModel& model) {
      return actuator::PhysicalTerm(model, static_cast<int>(t));
    };
    const actuator::Term term = physical(trace.corrected);
    const effects::EffectInfo& info = term.effect->info();
    const bool was = t < trace.declared.terms.size() && term.declared;
    for (std::size_t i = 0; i < info.linear.size() + info.nonlinear.size(); ++i) {
      const bool linear = i < info.linear.size();
      const std::size_t k = linear ? i : i - info.linear.size();
      const auto& parameter = linear ? info.linear[k] : info.nonlinear[k];
      const auto& value = linear ? term.linear[k] : term.nonlinear[k];
      std::string refitted = "&ndash;";
      std::string declared = "&ndash;";
      if (was) {
        const actuator::Term before = physical(trace.declared);
        refitted = Short(linear ? before.linear[k].value : before.nonlinear[k].value);
        const actuator::Term nominal = physical(trace.nominal);
        declared = Short(linear ? nominal.linear[k].value : nominal.nonlinear[k].value);
      }
      out += HtmlRow({"<code>" + Escape(info.name) + "." +
                          Escape(effects::ParameterKey(parameter, kind)) + "</code>",
                      declared, refitted, Short(value.value),
                      value.fixed && !value.half_width_95 ? "known"
                      : value.half_width_95               ? Short(*value.half_width_95)
                                                          : "&ndash;"});
    }
  }
  out += "</table>\n";

  if (!trace.shifts.empty()) {
    out +=
        "<h2>Absorbed by refitting</h2>\n<p class=\"caption\">Declared parameters that moved by "
        "more "
        "than their tolerance, and effects that would move them in the same way.</p><table>" +
        HtmlRow({"parameter", "declared", "refitted", "tolerance", "sigma",
                 "causes that share the direction"},
                "th");
    for (const trace::ParameterShift& shift : trace.shifts) {
      out += HtmlRow({"<code>" + Escape(shift.effect) + "." + Escape(shift.parameter) + "</code>",
                      Short(shift.nominal), Short(shift.refit), Short(shift.tolerance),
                      Short(shift.sigma),
                      shift.causes.empty() ? "none known" : Escape(types::Joined(shift.causes))});
    }
    out += "</table>\n";
  }

  if (report.as_published) {
    const identify::AsPublishedResult& published = *report.as_published;
    out += "<h2>With the publication's own processing</h2>\n<table>" +
           HtmlRow({"relative error of the drive", "declared model", "with the effect"}, "th") +
           HtmlRow({"training recording", Short(published.before_percent) + " %",
                    Short(published.after_percent) + " %"}) +
           HtmlRow({"cross test on the held-out recording",
                    Short(published.cross_before_percent) + " %",
                    Short(published.cross_after_percent) + " %"}) +
           "</table>\n";
  }

  out += "<h2>Effects not excited by these recordings</h2>\n";
  if (trace.not_excited.empty()) {
    out += "<p>None: every effect of the catalogue would have been detected.</p>\n";
  } else {
    out += "<table>" + HtmlRow({"effect", "why"}, "th");
    for (const trace::NotExcited& hidden : trace.not_excited) {
      out += HtmlRow({"<code>" + Escape(hidden.effect) + "</code>", Escape(hidden.reason)});
    }
    out += "</table>\n";
  }

  out += Detectable(trace) + "<h2>What the model leaves unexplained</h2>\n<p>";
  if (trace.unexplained.variable.empty()) {
    out += "No part of the residual follows a single measured variable.";
  } else {
    out += Escape(trace.unexplained.variable) +
           (trace.unexplained.order_per_turn > 0.0
                ? ", order " + Short(trace.unexplained.order_per_turn) + " per turn"
                : "") +
           " predicts another " + Percent(trace.unexplained.share) + " of the residual (" +
           Short(trace.unexplained.rms) + " " + unit + " rms).";
  }
  out += "</p>\n" + FormatFaultTable(report.faults) + "<h2>The data</h2>\n<ul>";
  if (trace.rows > 0) {
    out += "<li>" + RowsText(trace) + "</li>\n";
  }
  for (const identify::Finding& finding : report.findings) {
    out += "<li>" + Escape(finding.text) + "</li>\n";
  }
  out +=
      "</ul>\n<h2>Method</h2>\n<p class=\"meta\">Zero-phase filters: states " +
      Short(report.processing.state_cutoff_Hz) + " Hz" +
      (trace.by_simulation
           ? std::string("; fits by simulation, the start state of every piece free")
           : ", both sides of the balance " + Short(report.processing.parallel_cutoff_Hz) + " Hz") +
      Method(report) +
      "</p>\n"
      "</main></body></html>\n";
  return out;
}

}  // namespace sinew::report
