#include <cmath>
#include <nlohmann/json.hpp>

#include "components/base/types/json_text.h"
#include "components/model/report/errors.h"
#include "components/model/report/file/recordings_json.h"
#include "components/model/report/file/report_file.h"
#include "components/model/trace/rules.h"

namespace sinew::report {

namespace {

using Json = nlohmann::ordered_json;

Json Value(double value, const std::optional<double>& half_width, bool fixed) {
  Json out = {{"value", value}};
  if (half_width) {
    out["half_width_95"] = *half_width;
    out["interval_95"] = {value - *half_width, value + *half_width};
  }
  if (fixed && !half_width) out["known"] = true;
  return out;
}

// Parameters of a term, linear ones in their own units (actuator::PhysicalTerm).
Json Parameters(const actuator::Term& term, types::JointKind kind) {
  const effects::EffectInfo& info = term.effect->info();
  Json out = Json::object();
  const auto add = [&](const effects::ParameterInfo& parameter,
                       const actuator::ParameterValue& value) {
    out[effects::ParameterKey(parameter, kind)] =
        Value(value.value, value.half_width_95, value.fixed);
  };
  for (std::size_t i = 0; i < info.linear.size(); ++i) add(info.linear[i], term.linear[i]);
  for (std::size_t i = 0; i < info.nonlinear.size(); ++i) add(info.nonlinear[i], term.nonlinear[i]);
  return out;
}

Json ModelParameters(const actuator::JointModel& model) {
  Json out = Json::object();
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    std::string name = model.terms[t].effect->info().name;
    int before = 0;  // the same effect with another setting
    for (std::size_t k = 0; k < t; ++k)
      before += model.terms[k].effect->info().name == name ? 1 : 0;
    if (before > 0) name += "#" + std::to_string(before + 1);
    const Json parameters =
        Parameters(actuator::PhysicalTerm(model, static_cast<int>(t)), model.kind);
    for (const auto& [key, value] : parameters.items()) out[name + "." + key] = value;
  }
  return out;
}

// M, L, S, Q, K as in docs/model.md.
std::string BalanceLetter(effects::Balance balance) {
  switch (balance) {
    case effects::Balance::kLink:
      return "L";
    case effects::Balance::kPlay:
      return "S";
    case effects::Balance::kGas:
      return "Q";
    case effects::Balance::kKinematic:
      return "K";
    case effects::Balance::kMotion:
      break;
  }
  return "M";
}

Json Errors(const identify::ModelError& nominal, const identify::ModelError& before,
            const identify::ModelError& after, const std::string& unit) {
  return {{"unit", unit},
          {"declared_rms", nominal.rms},
          {"refitted_rms", before.rms},
          {"corrected_rms", after.rms},
          {"declared_percent", nominal.percent},
          {"refitted_percent", before.percent},
          {"corrected_percent", after.percent},
          {"before", before.rms},
          {"after", after.rms},
          {"before_rms", before.rms},
          {"after_rms", after.rms},
          {"before_percent", before.percent},
          {"after_percent", after.percent}};
}

Json Train(const trace::Assessment& result, const std::string& unit) {
  return Errors(result.nominal_train, result.before_train, result.after_train, unit);
}

Json HeldOut(const trace::Assessment& result, const std::string& unit) {
  Json out = Errors(result.nominal_held_out, result.before_held_out, result.after_held_out, unit);
  const double floor = result.noise_floor_rms;
  const double before = result.before_held_out.rms * result.before_held_out.rms;
  const double after = result.after_held_out.rms * result.after_held_out.rms;
  const double explainable = before - floor * floor;
  out["noise_floor_rms"] = floor;
  out["noise_floor_source"] = result.noise_floor_source;
  out["ceiling_rms"] = result.ceiling_rms;
  out["explainable_removed"] =
      explainable > 0.0 ? Json((before - after) / explainable) : Json(nullptr);
  return out;
}

Json Rounds(const trace::Assessment& result) {
  Json out = Json::array();
  for (const trace::RoundReport& round : result.rounds) {
    Json candidates = Json::array();
    for (const trace::CandidateScore& score : round.scores) {
      candidates.push_back({{"name", score.name},
                            {"gain", score.gain_share},
                            {"statistic", score.statistic},
                            {"accepted", score.accepted},
                            {"refused", score.refused.rule},
                            {"value", score.refused.value},
                            {"limit", score.refused.limit}});
    }
    out.push_back({{"train_rms", round.train_rms},
                   {"held_out_rms", round.held_out_rms},
                   {"explainable_rms", round.explainable_rms},
                   {"candidates", std::move(candidates)}});
  }
  return out;
}

Json Blocks(const trace::Assessment& result) {
  return {{"count", result.blocks}, {"length_s", result.block_length_s}};
}

Json ErrorLines(const std::vector<ErrorLine>& lines) {
  Json out = Json::array();
  for (const ErrorLine& line : lines) {  // an error that is not finite is null
    out.push_back({{"what", line.key},
                   {"balance", BalanceLetter(line.balance)},
                   {"unit", line.unit},
                   {"declared", line.declared},
                   {"refitted", line.refitted},
                   {"corrected", line.corrected}});
  }
  return out;
}

Json Simulated(const Report& report) {
  if (!report.free_run.errors) {
    return {{"before", nullptr}, {"after", nullptr}, {"why_not", report.free_run.why_not}};
  }
  const free_run::FreeRun& run = *report.free_run.errors;
  const bool closed = run.method == free_run::Method::kClosedLoop;
  Json out = {{"unit", report.trace.corrected.kind == types::JointKind::kRotary ? "rad" : "m"},
              {"method", closed ? "closed_loop" : "horizons"},
              {"horizon_s", closed ? Json(nullptr) : Json(run.horizon_s)},
              {"before", run.models.at(kRefittedModel).rms},
              {"after", run.models.at(kCorrectedModel).rms}};
  const auto add = [&](const std::string& name, const free_run::ModelError& model) {
    out[name + "_rms"] = model.rms;
    out[name + "_mean_abs"] = model.mean_abs;
    out[name + "_diverged"] = model.diverged;
  };
  add("declared", run.models.at(kDeclaredModel));
  add("refitted", run.models.at(kRefittedModel));
  add("corrected", run.models.at(kCorrectedModel));
  add("before", run.models.at(kRefittedModel));
  add("after", run.models.at(kCorrectedModel));
  return out;
}

// With 80 % power, by the rules of the search that are named.
Json Detectable(const trace::TraceResult& trace) {
  Json sizes = Json::array();
  for (const trace::DetectableSize& size : trace.detectable) {
    Json shape = Json::object();
    for (const auto& [key, value] : size.shape) shape[key] = value;
    sizes.push_back({{"effect", size.effect},
                     {"balance", BalanceLetter(size.balance)},
                     {"parameter", size.parameter},
                     {"unit", size.unit.empty() ? "1" : size.unit},
                     {"size", size.size},
                     {"share_of_measured_side", size.share},
                     {"of_expected", size.of_expected},
                     {"shape", std::move(shape)}});
  }
  return {{"power", 0.8},
          {"p_global", trace::Limit(trace::rules::kGlobalP)},
          {"torque_share", trace::Limit(trace::rules::kTorqueShare)},
          {"explained_share", trace::Limit(trace::rules::kExplainedShare)},
          {"sizes", std::move(sizes)}};
}

Json RowsJson(const trace::TraceResult& trace) {
  Json speeds = Json::array(), reasons = Json::object();
  const char* key = trace.corrected.kind == types::JointKind::kRotary ? "up_to_rad_s" : "up_to_m_s";
  for (const trace::RowUsage::Speed& speed : trace.row_usage.by_speed) {
    speeds.push_back({{key, speed.up_to}, {"rows", speed.rows}, {"used", speed.used}});
  }
  for (const auto& [reason, rows] : trace.row_usage.not_used) reasons[reason] = rows;
  return {{"training", trace.rows},
          {"used", trace.used_rows},
          {"by_speed", std::move(speeds)},
          {"not_used", std::move(reasons)}};
}

Json PosteriorJson(const trace::Posterior& posterior) {
  Json out = Json::array();
  for (const trace::NameProbability& entry : posterior) {
    out.push_back({{"name", entry.name}, {"probability", entry.probability}});
  }
  return out;
}

Json Rotations(const Report& report, const std::string& unit) {
  Json out = Json::array();
  for (const trace::Rotation& rotation : report.rotations) {
    Json effects = Json::array();
    for (const auto* list :
         {&rotation.trace.effects, &rotation.trace.open, &rotation.trace.refuted}) {
      for (const trace::FoundEffect& effect : *list) {
        effects.push_back(
            {{"name", effect.name},
             {"rivals", effect.rivals()},
             {"confirmation", trace::ConfirmationWord(effect.confirmation.verdict)},
             {"slope", effect.confirmation.slope},
             {"interval_95", {effect.confirmation.lower, effect.confirmation.upper}}});
      }
    }
    out.push_back({{"held_out", rotation.held_out},
                   {"verdict", VerdictWord(rotation.trace.verdict)},
                   {"effects", std::move(effects)},
                   {"unit", unit},
                   {"declared", rotation.trace.nominal_held_out.rms},
                   {"refitted", rotation.trace.before_held_out.rms},
                   {"corrected", rotation.trace.after_held_out.rms}});
  }
  return out;
}

Json VariableOf(const trace::Unexplained& unexplained) {
  return unexplained.variable.empty() ? Json(nullptr) : Json(unexplained.variable);
}

}  // namespace

std::string FormatJson(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const std::string unit = ErrorUnit(trace);
  Json out;
  out["schema"] = "sinew-close-loop/2";
  out["verdict"] = VerdictWord(trace.verdict);
  out["outcome"] = OutcomeWord(trace);
  out["sentence"] = VerdictSentence(report);
  out["robot"] = report.robot;
  out["joint"] = trace.corrected.name;
  out["model"] = report.model_file;
  if (trace.by_simulation) out["by"] = "simulation";
  out["recordings"] = {{"train", RecordingsJson(report.train)},
                       {"held_out", RecordingsJson(report.held_out)}};

  out["p_global"] = trace.p_global ? Json(*trace.p_global) : Json(nullptr);
  out["faults"] = FaultsJson(report.faults);
  if (report.given) out["given_effects"] = *report.given;
  if (!trace::TakenOut().empty()) out["without_rules"] = trace::TakenOut();
  const auto entry_of = [&](const trace::FoundEffect& effect) {
    const std::string own_unit = ErrorUnit(trace, effect.balance);
    Json entry = {
        {"name", effect.name},
        {"title", EffectTitle(effect.name)},
        {"balance", BalanceLetter(effect.balance)},
        {"rivals", effect.rivals()},
        {"posterior", PosteriorJson(effect.posterior)},
        {"in_model", effect.in_model()},
        {"parameters", Parameters(FittedTerm(trace, effect), trace.corrected.kind)},
        {"gain", effect.gain_share},
        {"p", effect.p},
        {"confirmation",
         {{"verdict", trace::ConfirmationWord(effect.confirmation.verdict)},
          {"slope", effect.confirmation.slope},
          {"interval_95", {effect.confirmation.lower, effect.confirmation.upper}},
          {"blocks", effect.confirmation.blocks}}},
        {"weak_evidence", effect.weak_evidence},
        {"train",
         {{"unit", own_unit}, {"before", effect.train_before}, {"after", effect.train_after}}},
        {"held_out",
         {{"unit", own_unit},
          {"before", effect.held_out_before},
          {"after", effect.held_out_after}}}};
    entry["sealed"] = entry["held_out"];  // the name of schema 1, kept for its readers
    entry["score"] = {{"p", effect.score}, {"curve", effect.curve}};
    if (!effect.refusal.rule.empty()) {
      entry["refused"] = {{"rule", effect.refusal.rule},
                          {"value", effect.refusal.value},
                          {"limit", effect.refusal.limit}};
    }
    return entry;
  };
  for (const auto& [key, list] :
       {std::pair{"effects", &trace.effects}, std::pair{"open", &trace.open},
        std::pair{"refuted", &trace.refuted}}) {
    out[key] = Json::array();
    for (const trace::FoundEffect& effect : *list) out[key].push_back(entry_of(effect));
  }

  out["events"] = Json::array();
  for (const trace::EventTime& event : trace.events) {
    out["events"].push_back({{"effect", event.effect},
                             {"recording", event.recording},
                             {"held_out", event.held_out},
                             {"start_s", event.start_s}});
  }
  out["zero_turns"] = Json::array();
  for (const trace::ZeroTurn& turn : trace.zero_turns) {
    out["zero_turns"].push_back(
        {{"effect", turn.effect}, {"recording", turn.recording}, {"turn_rad", turn.turn_rad}});
  }
  out["rotations"] = Rotations(report, unit);
  out["train"] = Train(trace, unit);
  out["held_out"] = HeldOut(trace, unit);
  out["sealed"] = out["held_out"];  // the name of schema 1, kept for its readers
  out["balances"] = Json::array();
  for (const trace::BalanceSummary& summary : trace.balances) {
    Json entry = {{"balance", BalanceLetter(summary.balance)},
                  {"name", effects::BalanceName(summary.balance)},
                  {"unit", summary.unit},
                  {"verdict", VerdictWord(summary.verdict)},
                  {"unseen", summary.unseen.empty() ? Json(nullptr) : Json(summary.unseen)}};
    if (summary.unseen.empty()) {
      entry["train"] = Train(summary, summary.unit);
      entry["held_out"] = HeldOut(summary, summary.unit);
      entry["unexplained"] = {{"variable", VariableOf(summary.unexplained)},
                              {"order_per_turn", summary.unexplained.order_per_turn},
                              {"rms", summary.unexplained.rms}};
      entry["rounds"] = Rounds(summary);
      entry["blocks"] = Blocks(summary);
    }
    entry["effects"] = Json::array();
    for (const trace::FoundEffect& effect : trace.effects) {
      if (effect.balance == summary.balance) entry["effects"].push_back(effect.name);
    }
    out["balances"].push_back(std::move(entry));
  }

  out["rounds"] = Rounds(trace);

  if (report.as_published) {
    const identify::AsPublishedResult& published = *report.as_published;
    out["as_published"] = {{"before_percent", published.before_percent},
                           {"after_percent", published.after_percent},
                           {"cross_before_percent", published.cross_before_percent},
                           {"cross_after_percent", published.cross_after_percent},
                           {"parameters",
                            {{"before", ModelParameters(published.before)},
                             {"after", ModelParameters(published.after)}}}};
  }

  out["errors"] = ErrorLines(ErrorTable(report));
  out["rises"] = ErrorLines(Rises(report));
  out["free_run"] = Simulated(report);
  out["not_excited"] = Json::array();
  out["not_excited_why"] = Json::object();
  for (const trace::NotExcited& hidden : trace.not_excited) {
    out["not_excited"].push_back(hidden.effect);
    out["not_excited_why"][hidden.effect] = hidden.reason;
  }
  out["detectable"] = Detectable(trace);
  const double floor = trace.noise_floor_rms;
  const double left = trace.after_train.rms * trace.after_train.rms - floor * floor;
  out["unexplained"] = {{"variable", VariableOf(trace.unexplained)},
                        {"order_per_turn", trace.unexplained.order_per_turn},
                        {"balance", BalanceLetter(trace.unexplained.balance)},
                        {"rms", trace.unexplained.variable.empty() ? std::sqrt(std::max(0.0, left))
                                                                   : trace.unexplained.rms},
                        {"share", trace.unexplained.share}};
  out["parameter_shift"] = Json::array();
  for (const trace::ParameterShift& shift : trace.shifts) {
    out["parameter_shift"].push_back({{"name", shift.effect + "." + shift.parameter},
                                      {"nominal", shift.nominal},
                                      {"refit", shift.refit},
                                      {"tolerance", shift.tolerance},
                                      {"half_width_95", shift.half_width_95},
                                      {"sigma", shift.sigma},
                                      {"causes", shift.causes}});
  }
  out["base_parameters"] = {{"nominal", ModelParameters(trace.nominal)},
                            {"before", ModelParameters(trace.declared)},
                            {"after", ModelParameters(trace.corrected)}};
  out["findings"] = Json::array();
  for (const identify::Finding& finding : report.findings) {
    out["findings"].push_back({{"name", finding.name},
                               {"text", finding.text},
                               {"value", finding.value},
                               {"unit", finding.unit}});
  }
  const std::string next = NextExperiment(report);
  out["next_experiment"] = next.empty() ? Json(nullptr) : Json(next);
  out["blocks"] = Blocks(trace);
  out["rows"] = RowsJson(trace);
  out["processing"] = {{"state_cutoff_Hz", report.processing.state_cutoff_Hz},
                       {"state_order", report.processing.state_order},
                       {"parallel_cutoff_Hz", report.processing.parallel_cutoff_Hz},
                       {"parallel_order", report.processing.parallel_order},
                       {"rest_velocity", report.processing.rest_velocity},
                       {"reversal_guard_s", report.processing.reversal_guard_s},
                       {"settle_distance", report.processing.settle_distance},
                       {"border_s", report.processing.border_s}};
  out["seed"] = report.seed;
  out["seconds"] = report.seconds;
  return types::JsonText(out, 2) + "\n";
}

}  // namespace sinew::report
