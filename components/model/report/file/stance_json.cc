#include <nlohmann/json.hpp>

#include "components/model/report/file/report_file.h"

namespace sinew::report {

namespace {

using Json = nlohmann::ordered_json;

Json OfPayload(const stance_fit::PlacedPayload& payload) {
  Json place = Json::array(), width = place, excited = place;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    place.push_back(payload.place_m[axis]);
    width.push_back(payload.place_half_width_95[axis]);
    excited.push_back(payload.excited[static_cast<std::size_t>(axis)]);
  }
  return {{"link", payload.link_name},  {"rigid_with", payload.rigid_with},
          {"mass_kg", payload.mass_kg}, {"mass_half_width_95_kg", payload.mass_half_width_95},
          {"position_m", place},        {"position_half_width_95_m", width},
          {"position_excited", excited}};
}

Json OfEffects(const std::vector<stance_fit::StanceEffect>& effects) {
  Json out = Json::array();
  for (const stance_fit::StanceEffect& effect : effects) {
    Json entry = {{"effect", effect.name}, {"place", effect.place}};
    if (effect.payload) entry["payload"] = OfPayload(*effect.payload);
    if (effect.term) {
      const effects::EffectInfo& info = effect.term->effect->info();
      Json parameters = Json::object();
      const auto add = [&](const auto& names, const auto& values) {
        for (std::size_t i = 0; i < names.size(); ++i) {
          Json& to = parameters[effects::ParameterKey(names[i], types::JointKind::kRevolute)];
          to["value"] = values[i].value;
          if (values[i].half_width_95) to["half_width_95"] = *values[i].half_width_95;
        }
      };
      add(info.linear, effect.term->linear);
      add(info.nonlinear, effect.term->nonlinear);
      entry["parameters"] = parameters;
    }
    entry["gain_share"] = effect.gain_share;
    entry["p"] = effect.p;
    entry["confirmation"] = {
        {"verdict", std::string(trace::ConfirmationWord(effect.confirmation.verdict))},
        {"slope", effect.confirmation.slope},
        {"lower", effect.confirmation.lower},
        {"upper", effect.confirmation.upper},
        {"blocks", effect.confirmation.blocks}};
    entry["posterior"] = PosteriorJson(effect.posterior);
    entry["in_model"] = effect.in_model;
    out.push_back(std::move(entry));
  }
  return out;
}

Json OfErrors(const stance_fit::StanceFitResult& result, bool held_out) {
  Json out = Json::object();
  for (const StanceErrorLine& line : StanceErrors(result, held_out)) {
    out[line.key] = {
        {"declared", line.declared}, {"corrected", line.corrected}, {"unit", line.unit}};
  }
  return out;
}

}  // namespace

Json ReportJson(const StanceReport& report) {
  const stance_fit::StanceFitResult& result = report.result;
  Json out = {{"robot", report.robot},
              {"model_file", report.model_file},
              {"verdict", VerdictWord(result.verdict)},
              {"sentence", VerdictSentence(report)}};
  if (result.too_little.empty()) {
    if (result.p_global) out["p_global"] = *result.p_global;
    out["effects"] = OfEffects(result.effects);
    out["refuted"] = OfEffects(result.refuted);
    out["unexplained"] = result.unexplained;
    out["errors"] = {{"held_out", OfErrors(result, true)}, {"train", OfErrors(result, false)}};
    Json hidden = Json::array(), sizes = hidden;
    for (const trace::NotExcited& entry : result.not_excited) {
      hidden.push_back({{"effect", entry.effect}, {"reason", entry.reason}});
    }
    for (const stance_fit::SmallestSize& size : result.detectable) {
      sizes.push_back(
          {{"effect", size.effect}, {"parameter", size.parameter}, {"size", size.size}});
    }
    Json shifts = Json::array();
    for (const StanceShift& shift : StanceShifts(report)) {
      shifts.push_back({{"parameter", shift.parameter},
                        {"declared", shift.declared},
                        {"corrected", shift.corrected},
                        {"tolerances", shift.tolerances}});
    }
    out["parameter_shift"] = shifts;
    out["not_excited"] = hidden;
    out["detectable"] = sizes;
    out["moving_joints"] = result.moving_joints;
    out["rows"] = result.rows;
    out["channels"] = result.channels;
    out["blocks"] = result.blocks;
    out["low_pass_Hz"] = result.low_pass_Hz;
  } else {
    out["too_little"] = result.too_little;
  }
  out["train"] = RecordingsJson(report.train);
  out["held_out"] = RecordingsJson(report.held_out);
  out["seed"] = report.seed;
  out["seconds"] = report.seconds;
  return out;
}

}  // namespace sinew::report
