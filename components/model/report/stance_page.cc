#include "components/model/report/stance_page.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/joined.h"
#include "components/model/report/section.h"

namespace sinew::report {

namespace {

using stance_fit::PlacedPayload;
using stance_fit::StanceEffect;
using stance_fit::StanceFitResult;

constexpr Eigen::Index kMostRows = 2500;  // of a picture
constexpr const char* kAxisNames[] = {"x", "y", "z"};

std::string PlaceText(const PlacedPayload& payload) {
  std::string shown, hidden;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    if (payload.excited[k]) {
      shown += (shown.empty() ? " at " : ", ") + std::string(kAxisNames[k]) + " " +
               Text("%.0f +- %.0f mm", 1e3 * payload.place_m[axis],
                    1e3 * payload.place_half_width_95[axis]);
    } else {
      hidden += (hidden.empty() ? "; not excited: " : ", ") + std::string(kAxisNames[k]);
    }
  }
  return shown + hidden;
}

std::string ProbableNames(const StanceEffect& effect) {
  std::string out;
  for (std::size_t i = 0; i < trace::NamedCount(effect.posterior); ++i) {
    out += (i > 0 ? " or " : "") + effect.posterior[i].name +
           Text(" (%.0f %%)", 100.0 * effect.posterior[i].probability);
  }
  return out;
}

std::string ConfirmedText(const trace::Confirmation& confirmation) {
  if (confirmation.blocks == 0) return "not tested";
  return std::string(trace::ConfirmationWord(confirmation.verdict)) + ", slope " +
         Short(confirmation.slope) + " [" + Short(confirmation.lower) + ", " +
         Short(confirmation.upper) + "]";
}

std::string ErrorTableHtml(const StanceFitResult& result) {
  std::string out = "<h2>Errors</h2>\n";
  for (const bool held_out : {true, false}) {
    out += "<table>" + HtmlRow({held_out ? "rms, held-out recordings" : "rms, training recordings",
                                "declared", "corrected", "unit"},
                               "th");
    for (const StanceErrorLine& line : StanceErrors(result, held_out)) {
      out += HtmlRow({Escape(line.what), Short(line.declared), Short(line.corrected), line.unit});
    }
    out += "</table>\n";
  }
  return out +
         "<p class=\"caption\">Declared: the model file as it is. Corrected: refitted to the "
         "training recordings with the effects that are in the model. Moments are about the point "
         "on the ground midway between the feet; a joint's torque is what is left once the forces "
         "that no sensor measures took what fits them best.</p>\n";
}

std::string EffectTable(const std::vector<StanceEffect>& effects, const char* title) {
  if (effects.empty()) return "";
  std::string out = "<h2>" + std::string(title) + "</h2>\n<table>" +
                    HtmlRow({"effect", "removes", "p", "held-out recordings", "names"}, "th");
  for (const StanceEffect& effect : effects) {
    std::string text = Escape(StanceEffectText(effect));
    if (effect.payload) {
      text += "<br>moves with " + Escape(types::Joined(effect.payload->rigid_with));
    }
    if (!effect.in_model) text += "<br>not in the model";
    out += HtmlRow({text, Text("%.1f %%", 100.0 * effect.gain_share), Text("%.2g", effect.p),
                    Escape(ConfirmedText(effect.confirmation)), Escape(ProbableNames(effect))});
  }
  return out + "</table>\n";
}

std::string Hidden(const StanceFitResult& result) {
  std::string out =
      "<h2>Not excited by these recordings</h2>\n<table>" + HtmlRow({"what", "why"}, "th");
  for (const trace::NotExcited& hidden : result.not_excited) {
    out += HtmlRow({Escape(hidden.effect), Escape(hidden.reason)});
  }
  if (result.not_excited.empty()) out += HtmlRow({"nothing", ""});
  return out + "</table>\n";
}

std::string SmallestSizes(const StanceFitResult& result) {
  if (result.detectable.empty()) return "";
  std::string out =
      "<h2>Smallest detectable sizes</h2>\n<p class=\"caption\">The smallest size of each effect "
      "that this search finds in 80 % of recordings like these, with the effect alone. Smaller "
      "effects may be present.</p><table>" +
      HtmlRow({"effect", "parameter", "smallest detectable size"}, "th");
  for (const stance_fit::SmallestSize& size : result.detectable) {
    out += HtmlRow({Escape(size.effect), "<code>" + Escape(size.parameter) + "</code>",
                    Text("%.2g", size.size)});
  }
  return out + "</table>\n";
}

std::string RecordingTable(const StanceReport& report) {
  std::string out = "<h2>The recordings</h2>\n<table>" +
                    HtmlRow({"recording", "used for", "rows", "duration, s"}, "th");
  for (const auto& [list, use] :
       {std::pair{&report.train, "training"}, std::pair{&report.held_out, "held out"}}) {
    for (const Recording& recording : *list) {
      out += HtmlRow({Escape(recording.name), use, std::to_string(recording.rows),
                      Short(recording.duration_s)});
    }
  }
  return out + "</table>\n";
}

std::string ShiftTable(const StanceReport& report) {
  const std::vector<StanceShift> shifts = StanceShifts(report);
  if (shifts.empty()) return "";
  std::string out =
      "<h2>Absorbed by refitting</h2>\n<p class=\"caption\">Declared values that moved by more "
      "than "
      "two tolerances. Less than what names an effect, but the corrected model has "
      "them.</p><table>" +
      HtmlRow({"parameter", "declared", "corrected", "tolerances"}, "th");
  for (const StanceShift& shift : shifts) {
    out += HtmlRow({"<code>" + Escape(shift.parameter) + "</code>", Short(shift.declared),
                    Short(shift.corrected), Text("%.1f", shift.tolerances)});
  }
  return out + "</table>\n";
}

Picture SeriesPicture(const stance_fit::BalanceSeries& series, Eigen::Index column,
                      const std::string& what, const std::string& unit) {
  Picture picture;
  picture.title = what + ": what the models leave of the held-out recordings";
  picture.caption = "Rows in use: both feet flat, every moving joint away from rest and reversals.";
  picture.script =
      PictureHead(300) + "set xlabel 'time from the start, s'\nset ylabel '" + unit + "'\n";
  const Eigen::Index rows = series.time_s.size();
  const Eigen::Index step = std::max<Eigen::Index>(1, rows / kMostRows);
  for (const auto& [name, values] :
       {std::pair{"$before", &series.before}, std::pair{"$after", &series.after}}) {
    picture.script += std::string(name) + " << EOD\n";
    for (Eigen::Index i = 0; i < rows; i += step) {
      picture.script += PictureNumber(series.time_s[i] - series.time_s[0]) + " " +
                        PictureNumber((*values)(i, column)) + "\n";
    }
    picture.script += "EOD\n";
  }
  picture.script += "plot $before with dots lw 2 lc rgb '" + std::string(kBeforeColour) +
                    "' title 'declared', $after with dots lw 2 lc rgb '" + kAfterColour +
                    "' title 'corrected'\n";
  return picture;
}

}  // namespace

std::string StanceEffectText(const StanceEffect& effect) {
  std::string out = effect.name + " of " + effect.place + ":";
  if (effect.payload) {
    return out + " " + Short(effect.payload->mass_kg) + " +- " +
           Short(effect.payload->mass_half_width_95) + " kg" + PlaceText(*effect.payload);
  }
  if (!effect.term) return out;
  const effects::EffectInfo& info = effect.term->effect->info();
  for (std::size_t i = 0; i < info.linear.size(); ++i) {
    const actuator::ParameterValue& value = effect.term->linear[i];
    out += " " + effects::ParameterKey(info.linear[i], types::JointKind::kRotary) + " = " +
           Short(value.value) + " +- " + Short(value.half_width_95.value_or(0.0));
  }
  return out;
}

std::string VerdictSentence(const StanceReport& report) {
  const StanceFitResult& result = report.result;
  if (!result.too_little.empty()) return "These recordings cannot show it: " + result.too_little;
  std::string found, unconfirmed;
  for (const StanceEffect& effect : result.effects) {
    std::string& to = effect.in_model ? found : unconfirmed;
    to += (to.empty() ? "" : "; ") + StanceEffectText(effect);
  }
  if (!found.empty()) {
    return "Missing from the model, and confirmed on the held-out recordings: " + found +
           (unconfirmed.empty() ? "." : ". Not confirmed: " + unconfirmed + ".");
  }
  if (!unconfirmed.empty()) {
    return "Nothing was confirmed on the held-out recordings, the model has no new effect. Not "
           "confirmed: " +
           unconfirmed + ".";
  }
  if (!result.unexplained.empty()) {
    return "Something follows " + result.unexplained +
           ", and neither a payload nor friction explains it.";
  }
  return "No effect: no payload and no friction explains what the declared model leaves of these "
         "recordings better than their noise.";
}

std::vector<StanceErrorLine> StanceErrors(const StanceFitResult& result, bool held_out) {
  const stance_fit::StanceError& before = held_out ? result.held_out_before : result.train_before;
  const stance_fit::StanceError& after = held_out ? result.held_out_after : result.train_after;
  std::vector<StanceErrorLine> out = {
      {"force_z_N", "vertical force", "N", before.force_z_N, after.force_z_N},
      {"moment_x_Nm", "moment about the forward axis", "Nm", before.moment_x_Nm, after.moment_x_Nm},
      {"moment_y_Nm", "moment about the axis to the left", "Nm", before.moment_y_Nm,
       after.moment_y_Nm}};
  for (std::size_t j = 0;
       j < result.moving_joints.size() && j < before.joints_Nm.size() && j < after.joints_Nm.size();
       ++j) {
    const std::string& name = result.moving_joints[j];
    out.push_back({name, "torque of " + name, "Nm", before.joints_Nm[j], after.joints_Nm[j]});
  }
  out.push_back(
      {"share", "all rows, in units of the sensors' noise", "1", before.share, after.share});
  return out;
}

std::vector<StanceShift> StanceShifts(const StanceReport& report) {
  std::vector<StanceShift> out;
  const auto named = [&](const std::string& effect, const std::string& joint) {
    return std::any_of(report.result.effects.begin(), report.result.effects.end(),
                       [&](const StanceEffect& one) {
                         return one.in_model && one.name == effect && one.place == joint;
                       });
  };
  const std::vector<actuator::JointModel>& corrected = report.result.corrected.joints;
  for (std::size_t j = 0; j < report.declared.joints.size() && j < corrected.size(); ++j) {
    const actuator::JointModel& joint = report.declared.joints[j];
    for (std::size_t t = 0; t < joint.terms.size() && t < corrected[j].terms.size(); ++t) {
      const effects::EffectInfo& info = joint.terms[t].effect->info();
      if (named(info.name, joint.name)) continue;
      for (std::size_t i = 0; i < info.linear.size(); ++i) {
        const actuator::ParameterValue& before = joint.terms[t].linear[i];
        const double after = corrected[j].terms[t].linear[i].value;
        const double spread = before.fixed ? 0.0 : actuator::PriorSpread(before);
        if (!(spread > 0.0) || !(std::abs(after - before.value) > kShift * spread)) continue;
        out.push_back({info.name + "." + effects::ParameterKey(info.linear[i], joint.kind) +
                           " of " + joint.name,
                       before.value, after, (after - before.value) / spread});
      }
    }
  }
  return out;
}

std::vector<Picture> MakePictures(const StanceReport& report) {
  const stance_fit::BalanceSeries& series = report.result.held_out;
  if (series.time_s.size() == 0) return {};
  return {SeriesPicture(series, 2, "Vertical force", "N"),
          SeriesPicture(series, 0, "Moment about the forward axis", "Nm"),
          SeriesPicture(series, 1, "Moment about the axis to the left", "Nm")};
}

std::string FormatHtml(const StanceReport& report, const std::vector<Picture>& pictures,
                       const std::vector<std::string>& svgs) {
  const StanceFitResult& result = report.result;
  std::string out = HtmlHead("Closing the loop: " + report.robot);
  out += "<h1>Closing the loop: " + Escape(report.robot) + ", on two feet</h1>\n" +
         "<div class=\"meta\">Trained on " + Escape(NamesOf(report.train)) +
         ". Held out: " + Escape(NamesOf(report.held_out)) + ". Model " +
         Escape(report.model_file) + ".</div>\n" + "<div class=\"verdict " +
         VerdictWord(result.verdict) + "\">" + Escape(VerdictSentence(report)) + "</div>\n";
  if (!result.too_little.empty()) {
    return out + "<h2>Next experiment</h2><p>Squats of 10 s and more, both feet flat.</p>\n" +
           RecordingTable(report) + "</main></body></html>\n";
  }
  out += ErrorTableHtml(result) + EffectTable(result.effects, "Effects found") +
         EffectTable(result.refuted, "Refuted on the held-out recordings");
  for (std::size_t i = 0; i < pictures.size() && i < svgs.size(); ++i) {
    out += "<figure><h3>" + Escape(pictures[i].title) + "</h3>" + svgs[i] +
           "<p class=\"caption\">" + Escape(pictures[i].caption) + "</p></figure>\n";
  }
  out += ShiftTable(report) + Hidden(result) + SmallestSizes(result) + RecordingTable(report);
  return out + "<h2>Method</h2>\n<p class=\"meta\">" + std::to_string(result.rows) +
         " rows in use, " + std::to_string(result.channels) +
         " channels of the balance of the floating base (components/model/stance_fit); low-pass " +
         Short(result.low_pass_Hz) + " Hz; p of the whole search " +
         Text("%.2g", result.p_global.value_or(1.0)) + " by sign flips of " +
         std::to_string(result.blocks) + " blocks, seed " + std::to_string(report.seed) + "; " +
         Short(report.seconds) + " s.</p>\n</main></body></html>\n";
}

}  // namespace sinew::report
