#include "components/model/report/stance_page.h"

#include <algorithm>
#include <cmath>

#include "components/base/types/joined.h"
#include "components/model/report/page_parts.h"

namespace sinew::report {

namespace {

using stance_fit::PlacedPayload;
using stance_fit::StanceEffect;
using stance_fit::StanceFitResult;

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

Section ErrorSection(const StanceFitResult& result) {
  Section out = {.title = "Errors"};
  for (const bool held_out : {true, false}) {
    out.tables.push_back(
        {.header = {held_out ? "rms, held-out recordings" : "rms, training recordings", "declared",
                    "corrected", "unit"}});
    for (const StanceErrorLine& line : StanceErrors(result, held_out)) {
      out.Add({line.what, Short(line.declared), Short(line.corrected), line.unit});
    }
  }
  out.tables.back().caption =
      "Declared: the model file as it is. Corrected: refitted to the training recordings with the "
      "effects that are in the model. Moments are about the point on the ground midway between the "
      "feet; a joint's torque is what is left once the forces that no sensor measures took what "
      "fits them best.";
  return out;
}

Section EffectSection(const std::vector<StanceEffect>& effects, const char* title) {
  Section out = TableSection(title, {"effect", "removes", "p", "held-out recordings", "names"});
  for (const StanceEffect& effect : effects) {
    std::string text = StanceEffectText(effect);
    if (effect.payload) text += "\nmoves with " + types::Joined(effect.payload->rigid_with);
    if (!effect.in_model) text += "\nnot in the model";
    out.Add({text, Percent(effect.gain_share), Text("%.2g", effect.p),
             ConfirmedText(effect.confirmation), NamedSetText(effect.posterior)});
  }
  return out;
}

Section DetectableSection(const StanceFitResult& result) {
  Section out =
      TableSection("Smallest detectable sizes", {"effect", "parameter", "smallest detectable size"},
                   "The smallest size of each effect that this search finds in 80 % of recordings "
                   "like these, with the effect alone. Smaller effects may be present.",
                   true);
  for (const stance_fit::SmallestSize& size : result.detectable) {
    out.Add({size.effect, size.parameter, Text("%.2g", size.size)});
  }
  return out;
}

Section ShiftSection(const StanceReport& report) {
  Section out = TableSection(
      "Absorbed by refitting", {"parameter", "declared", "corrected", "tolerances"},
      "Declared values that moved by more than two tolerances. Less than what names an "
      "effect, but the corrected model has them.");
  for (const StanceShift& shift : StanceShifts(report)) {
    out.Add({shift.parameter, Short(shift.declared), Short(shift.corrected),
             Text("%.1f", shift.tolerances)});
  }
  return out;
}

Picture SeriesPicture(const stance_fit::BalanceSeries& series, Eigen::Index column,
                      const std::string& what, const std::string& unit) {
  Series before = {"declared", kBeforeColour, {}, {}, "points pt 7 ps 0.3"};
  Series after = {"corrected", kAfterColour, {}, {}, "points pt 7 ps 0.3"};
  for (Eigen::Index i = 0; i < series.time_s.size(); ++i) {
    const double time_s = series.time_s[i] - series.time_s[0];
    before.Add(time_s, series.before(i, column));
    after.Add(time_s, series.after(i, column));
  }
  return Chart(what + ": what the models leave of the held-out recordings",
               "Rows in use: both feet flat, every moving joint away from rest and reversals.",
               "time from the start, s", 204, {{unit, {std::move(before), std::move(after)}}});
}

std::vector<Picture> Pictures(const stance_fit::BalanceSeries& series) {
  if (series.time_s.size() == 0) return {};
  return {SeriesPicture(series, 2, "Vertical force", "N"),
          SeriesPicture(series, 0, "Moment about the forward axis", "Nm"),
          SeriesPicture(series, 1, "Moment about the axis to the left", "Nm")};
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
    out += " " + effects::ParameterKey(info.linear[i], types::JointKind::kRevolute) + " = " +
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

Page MakePage(const StanceReport& report) {
  const StanceFitResult& result = report.result;
  Page page = {.title = "Closing the loop: " + report.robot + ", on two feet",
               .meta = MetaText(report.train, report.held_out, report.model_file),
               .verdict = VerdictWord(result.verdict),
               .outcome = VerdictWord(result.verdict),
               .sentence = VerdictSentence(report)};
  const Section recordings = RecordingsSection(report.train, report.held_out);
  if (!result.too_little.empty()) {
    page.sections = {NextSection("Squats of 10 s and more, both feet flat."), recordings};
    return page;
  }
  page.sections = {
      ErrorSection(result),
      EffectSection(result.effects, "Effects found"),
      EffectSection(result.refuted, "Refuted on the held-out recordings"),
      {.pictures = Pictures(result.held_out)},
      ShiftSection(report),
      NotExcitedSection(result.not_excited),
      DetectableSection(result),
      recordings,
      {.title = "Method",
       .paragraphs = {std::to_string(result.rows) + " rows in use, " +
                      std::to_string(result.channels) +
                      " channels of the balance of the floating base "
                      "(components/model/stance_fit); low-pass " +
                      Short(result.low_pass_Hz) + " Hz; p of the whole search " +
                      Text("%.2g", result.p_global.value_or(1.0)) + " by sign flips of " +
                      std::to_string(result.blocks) + " blocks, seed " +
                      std::to_string(report.seed) + "; " + Short(report.seconds) + " s."},
       .detail = true}};
  return page;
}

}  // namespace sinew::report
