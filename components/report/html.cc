#include <cstdio>

#include "components/report/gate_page.h"
#include "components/report/report.h"
#include "components/report/section.h"

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

// What the held-out recordings say of it, with the slope and its interval.
std::string Confirmed(const trace::Confirmation& confirmation) {
  if (confirmation.blocks == 0) return "not asked";
  return std::string(trace::ConfirmationWord(confirmation.verdict)) + "<br>slope " +
         Short(confirmation.slope) + " [" + Short(confirmation.lower) + ", " +
         Short(confirmation.upper) + "]";
}

std::string Refuted(const trace::TraceResult& trace) {
  if (trace.refuted.empty()) return "";
  std::string out =
      "<h2>What the sealed recording refuted</h2>\n<p class=\"caption\">The training recordings "
      "asked for these; the sealed one does not follow them, or its error rises, or their size may "
      "as well be zero. They are no part of the model.</p><table>" +
      HtmlRow({"effect", "removes", "sealed recording", "sealed error without and with it"}, "th");
  for (const trace::FoundEffect& effect : trace.refuted) {
    out +=
        HtmlRow({"<code>" + Escape(effect.name) + "</code><br>" + Escape(EffectTitle(effect.name)),
                 Percent(effect.gain_share), Confirmed(effect.confirmation),
                 Short(effect.sealed_before) + " &rarr; " + Short(effect.sealed_after) + " " +
                     std::string(effects::BalanceUnit(effect.balance, trace.corrected.kind))});
  }
  return out + "</table>\n";
}

// The method in one sentence.
std::string Method(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  return ". Sets of effects and free curves by their whitened likelihood, p of the whole search " +
         (trace.p_global ? Probability(*trace.p_global) : "unknown") + " by random signs of " +
         std::to_string(trace.units) + " blocks of " + Short(trace.unit_length_s) + " s, seed " +
         std::to_string(report.seed) +
         "; what was chosen is confirmed by the slope of the sealed recording's left-over. The "
         "rule that refused a candidate is in report.json.";
}

std::string Join(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : ", ") + Escape(word);
  return out;
}

}  // namespace

std::string FormatHtml(const Report& report, const std::vector<Picture>& pictures,
                       const std::vector<std::string>& svgs) {
  const trace::TraceResult& trace = report.trace;
  const effects::JointKind kind = trace.corrected.kind;
  const std::string unit = TorqueUnit(kind);
  std::string out = HtmlHead("Closing the loop: " + report.robot);
  out += "<h1>Closing the loop: " + Escape(report.robot) + ", " + Escape(trace.corrected.name) +
         "</h1>\n";
  std::vector<std::string> train;
  for (const Recording& recording : report.train) train.push_back(recording.name);
  std::vector<std::string> sealed;
  for (const Recording& recording : report.sealed) sealed.push_back(recording.name);
  out += "<div class=\"meta\">Trained on " + Join(train) + ". Sealed: " + Join(sealed) +
         ". Model " + Escape(report.model_file) + ".</div>\n";
  out += "<div class=\"verdict " + VerdictWord(trace.verdict) + "\">" +
         Escape(VerdictSentence(report)) + "</div>\n";
  const std::string next = NextExperiment(report);

  const auto box = [&](const std::string& value, const std::string& text) {
    out += "<div><b>" + value + "</b><span>" + text + "</span></div>\n";
  };
  out += "<div class=\"big\">\n";
  box(Short(trace.before_sealed.rms) + " &rarr; " + Short(trace.after_sealed.rms) + " " + unit,
      "error on the sealed recording, before and after");
  box(Short(trace.before_sealed.percent) + " &rarr; " + Short(trace.after_sealed.percent) + " %",
      "of the drive torque");
  box(Short(trace.noise_floor_rms) + " " + unit,
      "noise floor" + (trace.noise_floor_source.empty() ? std::string()
                                                        : ", " + Escape(trace.noise_floor_source)));
  box(Short(trace.ceiling_rms) + " " + unit,
      "left by the richest model: all effects, curves and lines together");
  if (report.free_run.errors) {
    const free_run::FreeRun& run = *report.free_run.errors;
    const bool closed = run.method == free_run::Method::kClosedLoop;
    std::string text = closed ? "position error, simulated in closed loop with the declared servo"
                              : "position error, simulated over " + Short(run.horizon_s) +
                                    " s from measured states";
    if (run.before_diverged + run.after_diverged > 0) {
      text += "; diverged " + std::to_string(run.before_diverged) + " &rarr; " +
              std::to_string(run.after_diverged);
    }
    box(Short(run.before_rms) + " &rarr; " + Short(run.after_rms) +
            (kind == effects::JointKind::kRotary ? " rad" : " m"),
        text);
  }
  out += "</div>\n";

  for (std::size_t i = 0; i < pictures.size() && i < svgs.size(); ++i) {
    out += "<figure><h3>" + Escape(pictures[i].title) + "</h3>" + svgs[i] +
           "<p class=\"caption\">" + Escape(pictures[i].caption) + "</p></figure>\n";
  }

  if (!trace.effects.empty()) {
    out +=
        "<h2>What was found</h2>\n<table>" + HtmlRow({"effect", "removes", "p", "sealed recording",
                                                      "sealed error", "what predicts the same"},
                                                     "th");
    for (const trace::FoundEffect& effect : trace.effects) {
      out += HtmlRow({"<code>" + Escape(EffectLabel(trace, effect)) + "</code><br>" +
                          Escape(EffectTitle(effect.name)),
                      Percent(effect.gain_share), Probability(effect.p),
                      Confirmed(effect.confirmation),
                      Short(effect.sealed_before) + " &rarr; " + Short(effect.sealed_after) + " " +
                          std::string(effects::BalanceUnit(effect.balance, trace.corrected.kind)),
                      effect.rivals.empty() ? "nothing known" : Join(effect.rivals)});
    }
    out += "</table>\n";
    if (!trace.events.empty()) {
      out += "<table>" + HtmlRow({"event", "recording", "began at, s"}, "th");
      for (const trace::EventTime& event : trace.events) {
        out += HtmlRow({"<code>" + Escape(event.effect) + "</code>",
                        Escape(event.recording) + (event.sealed ? " (sealed)" : ""),
                        Short(event.start_s)});
      }
      out += "</table>\n";
    }
    if (!next.empty()) out += "<p>" + Escape(next) + "</p>\n";
  } else if (!next.empty()) {
    out += "<h2>Next experiment</h2><p>" + Escape(next) + "</p>\n";
  }

  out += Refuted(trace);
  out += "<h2>Parameters</h2>\n<table>" +
         HtmlRow({"parameter", "declared", "refitted", "with the effect", "&plusmn; 95 %"}, "th");
  for (std::size_t t = 0; t < trace.corrected.terms.size(); ++t) {
    const actuator::Term& term = trace.corrected.terms[t];
    const effects::EffectInfo& info = term.effect->info();
    const bool was = t < trace.declared.terms.size() && term.declared;
    for (std::size_t i = 0; i < info.linear.size() + info.nonlinear.size(); ++i) {
      const bool linear = i < info.linear.size();
      const std::size_t k = linear ? i : i - info.linear.size();
      const auto& parameter = linear ? info.linear[k] : info.nonlinear[k];
      const auto& value = linear ? term.linear[k] : term.nonlinear[k];
      const double shown = linear ? actuator::PhysicalValue(trace.corrected, static_cast<int>(t),
                                                            static_cast<int>(k))
                                  : value.value;
      std::string refitted = "&ndash;";
      std::string declared = "&ndash;";
      if (was) {
        const actuator::Term& before = trace.declared.terms[t];
        refitted = Short(linear ? before.linear[k].value : before.nonlinear[k].value);
        const actuator::Term& nominal = trace.nominal.terms[t];
        declared = Short(linear ? nominal.linear[k].value : nominal.nonlinear[k].value);
      }
      out += HtmlRow({"<code>" + Escape(info.name) + "." +
                          Escape(effects::ParameterKey(parameter, kind)) + "</code>",
                      declared, refitted, Short(shown),
                      value.fixed && !value.half_width_95 ? "known"
                      : value.half_width_95               ? Short(*value.half_width_95)
                                                          : "&ndash;"});
    }
  }
  out += "</table>\n";

  if (!trace.shifts.empty()) {
    out +=
        "<h2>What the refit swallowed</h2>\n<p class=\"caption\">Declared parameters that moved by "
        "more than "
        "their tolerance, and what would move them the same way.</p><table>" +
        HtmlRow({"parameter", "declared", "refitted", "tolerance", "sigma",
                 "causes that share the direction"},
                "th");
    for (const trace::ParameterShift& shift : trace.shifts) {
      out +=
          HtmlRow({"<code>" + Escape(shift.effect) + "." + Escape(shift.parameter) + "</code>",
                   Short(shift.nominal), Short(shift.refit), Short(shift.tolerance),
                   Short(shift.sigma), shift.causes.empty() ? "none known" : Join(shift.causes)});
    }
    out += "</table>\n";
  }

  if (report.as_published) {
    const identify::AsPublishedResult& published = *report.as_published;
    out +=
        "<h2>With the publication's own processing</h2>\n<table>" +
        HtmlRow({"relative error of the drive", "declared model", "with the effect"}, "th") +
        HtmlRow({"training recording", Short(published.before_percent) + " %",
                 Short(published.after_percent) + " %"}) +
        HtmlRow({"cross test on the sealed recording", Short(published.cross_before_percent) + " %",
                 Short(published.cross_after_percent) + " %"}) +
        "</table>\n";
  }

  out += "<h2>What could not be seen</h2>\n";
  if (trace.not_excited.empty()) {
    out += "<p>Every effect of the catalogue would have shown.</p>\n";
  } else {
    out += "<table>" + HtmlRow({"effect", "why"}, "th");
    for (const trace::NotExcited& hidden : trace.not_excited) {
      out += HtmlRow({"<code>" + Escape(hidden.effect) + "</code>", Escape(hidden.reason)});
    }
    out += "</table>\n";
  }

  out += "<h2>What remains</h2>\n<p>";
  if (trace.unexplained.variable.empty()) {
    out += "Nothing that follows a single measured variable.";
  } else {
    out += Escape(trace.unexplained.variable) +
           (trace.unexplained.order_per_turn > 0.0
                ? ", order " + Short(trace.unexplained.order_per_turn) + " per turn"
                : "") +
           " predicts another " + Percent(trace.unexplained.share) + " of the residual (" +
           Short(trace.unexplained.rms) + " " + unit + " rms).";
  }
  out += "</p>\n" + FormatFaultTable(report.faults) + "<h2>The data</h2>\n<ul>";
  for (const identify::Finding& finding : report.findings) {
    out += "<li>" + Escape(finding.text) + "</li>\n";
  }
  out += "</ul>\n<h2>How it was judged</h2>\n<p class=\"meta\">Zero-phase filters: states " +
         Short(report.processing.state_cutoff_Hz) + " Hz, both sides of the balance " +
         Short(report.processing.parallel_cutoff_Hz) + " Hz" + Method(report) +
         "</p>\n"
         "</main></body></html>\n";
  return out;
}

}  // namespace sinew::report
