#include <cmath>
#include <nlohmann/json.hpp>

#include "components/model/report/errors.h"
#include "components/model/report/file/report_file.h"
#include "components/model/trace/rules.h"

namespace sinew::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "sinew-close-loop/3";

// A list: what `of` makes of each.
template <class List, class Of>
Json Each(const List& list, const Of& of) {
  Json out = Json::array();
  for (const auto& one : list) out.push_back(of(one));
  return out;
}

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

// As in docs/model.md, in the order of effects::Balance.
std::string BalanceLetter(effects::Balance balance) {
  constexpr std::string_view kLetters = "MLSQK";
  return std::string(1, kLetters[static_cast<std::size_t>(balance)]);
}

Json Errors(const identify::ModelError& nominal, const identify::ModelError& before,
            const identify::ModelError& after, const std::string& unit) {
  return {{"unit", unit},
          {"declared_rms", nominal.rms},
          {"refitted_rms", before.rms},
          {"corrected_rms", after.rms},
          {"declared_percent", nominal.percent},
          {"refitted_percent", before.percent},
          {"corrected_percent", after.percent}};
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
  if (result.scores.empty()) return Json::array();
  Json candidates = Each(result.scores, [](const trace::CandidateScore& score) -> Json {
    return {{"name", score.name},
            {"gain", score.gain_share},
            {"statistic", score.statistic},
            {"accepted", score.accepted},
            {"refused", score.refused.rule},
            {"value", score.refused.value},
            {"limit", score.refused.limit}};
  });
  return Json::array({{{"train_rms", result.before_train.rms},
                       {"held_out_rms", result.before_held_out.rms},
                       {"explainable_rms", result.ceiling_rms},
                       {"candidates", std::move(candidates)}}});
}

Json Blocks(const trace::Assessment& result) {
  return {{"count", result.blocks}, {"length_s", result.block_length_s}};
}

Json ErrorLines(const std::vector<ErrorLine>& lines) {
  return Each(lines, [](const ErrorLine& line) -> Json {  // an error that is not finite is null
    return {{"what", line.key},          {"balance", BalanceLetter(line.balance)},
            {"unit", line.unit},         {"declared", line.declared},
            {"refitted", line.refitted}, {"corrected", line.corrected}};
  });
}

Json Simulated(const Report& report) {
  if (!report.free_run.errors) return {{"why_not", report.free_run.why_not}};
  const free_run::FreeRun& run = *report.free_run.errors;
  const bool closed = run.method == free_run::Method::kClosedLoop;
  Json out = {{"unit", report.trace.corrected.kind == types::JointKind::kRevolute ? "rad" : "m"},
              {"method", closed ? "closed_loop" : "horizons"},
              {"horizon_s", closed ? Json(nullptr) : Json(run.horizon_s)}};
  for (const auto& [name, number] :
       {std::pair{"declared", kDeclaredModel}, std::pair{"refitted", kRefittedModel},
        std::pair{"corrected", kCorrectedModel}}) {
    const free_run::ModelError& model = run.models.at(number);
    out[name + std::string("_rms")] = model.rms;
    out[name + std::string("_mean_abs")] = model.mean_abs;
    out[name + std::string("_diverged")] = model.diverged;
  }
  return out;
}

// With 80 % power, by the rules of the search that are named.
Json Detectable(const trace::TraceResult& trace) {
  Json sizes = Each(trace.detectable, [](const trace::DetectableSize& size) -> Json {
    Json shape = Json::object();
    for (const auto& [key, value] : size.shape) shape[key] = value;
    return {{"effect", size.effect},
            {"balance", BalanceLetter(size.balance)},
            {"parameter", size.parameter},
            {"unit", size.unit.empty() ? "1" : size.unit},
            {"size", size.size},
            {"share_of_measured_side", size.share},
            {"of_expected", size.of_expected},
            {"shape", std::move(shape)}};
  });
  return {{"power", 0.8},
          {"p_global", trace.in_force.Limit(trace::rules::kGlobalP)},
          {"explained_share", trace.in_force.Limit(trace::rules::kExplainedShare)},
          {"sizes", std::move(sizes)}};
}

Json RowsJson(const trace::TraceResult& trace) {
  Json reasons = Json::object();
  const auto* key =
      trace.corrected.kind == types::JointKind::kRevolute ? "up_to_rad_s" : "up_to_m_s";
  Json speeds = Each(trace.row_usage.by_speed, [key](const trace::RowUsage::Speed& speed) -> Json {
    return {{key, speed.up_to}, {"rows", speed.rows}, {"used", speed.used}};
  });
  for (const auto& [reason, rows] : trace.row_usage.not_used) reasons[reason] = rows;
  return {{"training", trace.rows},
          {"used", trace.used_rows},
          {"by_speed", std::move(speeds)},
          {"not_used", std::move(reasons)}};
}

Json Rotations(const Report& report, const std::string& unit) {
  return Each(report.rotations, [&unit](const trace::Rotation& rotation) -> Json {
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
    return {{"held_out", rotation.held_out},
            {"verdict", VerdictWord(rotation.trace.verdict)},
            {"effects", std::move(effects)},
            {"unit", unit},
            {"declared", rotation.trace.nominal_held_out.rms},
            {"refitted", rotation.trace.before_held_out.rms},
            {"corrected", rotation.trace.after_held_out.rms}};
  });
}

Json OrNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

Json UnexplainedJson(const trace::Unexplained& unexplained) {
  return {{"variable", OrNull(unexplained.variable)},
          {"order_per_turn", unexplained.order_per_turn}};
}

Json EffectJson(const trace::TraceResult& trace, const trace::FoundEffect& effect) {
  const std::string unit = ErrorUnit(trace, effect.balance);
  Json out = {
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
      {"train", {{"unit", unit}, {"before", effect.train_before}, {"after", effect.train_after}}},
      {"held_out",
       {{"unit", unit}, {"before", effect.held_out_before}, {"after", effect.held_out_after}}}};
  out["sealed"] = out["held_out"];  // the name of schema 1, kept for its readers
  out["score"] = {{"p", effect.score}, {"curve", effect.curve}};
  if (!effect.refusal.rule.empty()) {
    out["refused"] = {{"rule", effect.refusal.rule},
                      {"value", effect.refusal.value},
                      {"limit", effect.refusal.limit}};
  }
  return out;
}

Json EventJson(const trace::EventTime& event) {
  return {{"effect", event.effect},
          {"recording", event.recording},
          {"held_out", event.held_out},
          {"start_s", event.start_s}};
}

Json ZeroTurnJson(const trace::ZeroTurn& turn) {
  return {{"effect", turn.effect}, {"recording", turn.recording}, {"turn_rad", turn.turn_rad}};
}

Json Balances(const trace::TraceResult& trace) {
  Json out = Json::array();
  for (const trace::BalanceSummary& summary : trace.balances) {
    Json entry = {{"balance", BalanceLetter(summary.balance)},
                  {"name", effects::BalanceName(summary.balance)},
                  {"unit", summary.unit},
                  {"verdict", VerdictWord(summary.verdict)},
                  {"unseen", OrNull(summary.unseen)}};
    if (summary.unseen.empty()) {
      entry["train"] = Train(summary, summary.unit);
      entry["held_out"] = HeldOut(summary, summary.unit);
      entry["unexplained"] = UnexplainedJson(summary.unexplained);
      entry["unexplained"]["rms"] = summary.unexplained.rms;
      entry["rounds"] = Rounds(summary);
      entry["blocks"] = Blocks(summary);
    }
    entry["effects"] = Json::array();
    for (const trace::FoundEffect& effect : trace.effects) {
      if (effect.balance == summary.balance) entry["effects"].push_back(effect.name);
    }
    out.push_back(std::move(entry));
  }
  return out;
}

Json AsPublished(const identify::AsPublishedResult& published) {
  return {{"before_percent", published.before_percent},
          {"after_percent", published.after_percent},
          {"cross_before_percent", published.cross_before_percent},
          {"cross_after_percent", published.cross_after_percent},
          {"parameters",
           {{"before", ModelParameters(published.before)},
            {"after", ModelParameters(published.after)}}}};
}

Json Unexplained(const trace::TraceResult& trace) {
  const double floor = trace.noise_floor_rms;
  const double left = trace.after_train.rms * trace.after_train.rms - floor * floor;
  Json out = UnexplainedJson(trace.unexplained);
  out["balance"] = BalanceLetter(trace.unexplained.balance);
  out["rms"] =
      trace.unexplained.variable.empty() ? std::sqrt(std::max(0.0, left)) : trace.unexplained.rms;
  out["share"] = trace.unexplained.share;
  return out;
}

Json ShiftJson(const trace::ParameterShift& shift) {
  return {{"name", shift.effect + "." + shift.parameter},
          {"nominal", shift.nominal},
          {"refit", shift.refit},
          {"tolerance", shift.tolerance},
          {"half_width_95", shift.half_width_95},
          {"sigma", shift.sigma},
          {"causes", shift.causes}};
}

Json Processing(const identify::ProcessingOptions& used) {
  return {
      {"state_cutoff_Hz", used.state_cutoff_Hz},       {"state_order", used.state_order},
      {"parallel_cutoff_Hz", used.parallel_cutoff_Hz}, {"parallel_order", used.parallel_order},
      {"rest_velocity", used.rest_velocity},           {"reversal_guard_s", used.reversal_guard_s},
      {"settle_distance", used.settle_distance},       {"border_s", used.border_s}};
}

Json FaultJson(const gate::Fault& fault) {
  Json out = {{"rule", fault.rule},
              {"signal", OrNull(fault.signal)},
              {"recording", OrNull(fault.recording)},
              {"accepted", fault.accepted},
              {"statistic", fault.statistic},
              {"limit", fault.limit},
              {"reason", fault.reason},
              {"remedy", fault.remedy}};
  if (fault.last_row >= fault.first_row && !fault.recording.empty()) {
    out["rows"] = {fault.first_row, fault.last_row};
    out["time_s"] = {fault.from_s, fault.to_s};
  }
  return out;
}

Json FindingJson(const gate::Finding& finding) {
  return {{"name", finding.name},
          {"text", finding.text},
          {"value", finding.value},
          {"unit", finding.unit}};
}

Json Start(const Report& report) {
  return {{"schema", kSchema},
          {"verdict", VerdictWord(report)},
          {"outcome", OutcomeWord(report)},
          {"sentence", VerdictSentence(report)},
          {"robot", report.robot},
          {"joint", report.joint},
          {"model", report.model_file}};
}

// Adds what was found: empty where nothing was traced.
void AddTrace(const Report& report, Json* out_json) {
  Json& out = *out_json;
  const trace::TraceResult& trace = report.trace;
  const std::string unit = ErrorUnit(trace);
  for (const auto& [key, list] :
       {std::pair{"effects", &trace.effects}, std::pair{"open", &trace.open},
        std::pair{"refuted", &trace.refuted}}) {
    out[key] = Each(
        *list, [&trace](const trace::FoundEffect& effect) { return EffectJson(trace, effect); });
  }
  out["events"] = Each(trace.events, EventJson);
  if (report.assessed()) {
    out["zero_turns"] = Each(trace.zero_turns, ZeroTurnJson);
    out["rotations"] = Rotations(report, unit);
    out["train"] = Train(trace, unit);
    out["held_out"] = HeldOut(trace, unit);
    out["sealed"] = {{"unit", unit},  // as in schema 1, for its readers
                     {"before", trace.before_held_out.rms},
                     {"after", trace.after_held_out.rms}};
    out["balances"] = Balances(trace);
    out["rounds"] = Rounds(trace);
    if (report.as_published) out["as_published"] = AsPublished(*report.as_published);
    out["errors"] = ErrorLines(ErrorTable(report));
    out["rises"] = ErrorLines(Rises(report));
    out["free_run"] = Simulated(report);
  } else {
    for (const char* key : {"errors", "rises", "balances", "rounds"}) out[key] = Json::array();
  }
  out["not_excited"] = Json::array();
  out["not_excited_why"] = Json::object();
  for (const trace::NotExcited& hidden : trace.not_excited) {
    out["not_excited"].push_back(hidden.effect);
    out["not_excited_why"][hidden.effect] = hidden.reason;
  }
  if (report.assessed()) {
    out["detectable"] = Detectable(trace);
    out["unexplained"] = Unexplained(trace);
  } else {
    out["unexplained"] = {{"variable", nullptr}};
  }
  out["parameter_shift"] = Each(trace.shifts, ShiftJson);
}

}  // namespace

Json PosteriorJson(const trace::Posterior& posterior) {
  return Each(posterior, [](const trace::NameProbability& entry) -> Json {
    return {{"name", entry.name}, {"probability", entry.probability}};
  });
}

Json RecordingsJson(const std::vector<Recording>& recordings) {
  return Each(recordings, [](const Recording& recording) -> Json {
    return {{"name", recording.name},
            {"content_hash", recording.content_hash},
            {"rows", recording.rows},
            {"duration_s", recording.duration_s}};
  });
}

Json ReportJson(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  Json out = Start(report);
  if (trace.by_simulation) out["by"] = "simulation";
  out["recordings"] = {{"train", RecordingsJson(report.train)},
                       {"held_out", RecordingsJson(report.held_out)}};
  if (report.assessed()) out["p_global"] = trace.p_global ? Json(*trace.p_global) : Json(nullptr);
  out["faults"] = Each(report.gate.faults, FaultJson);
  if (report.given && report.assessed()) out["given_effects"] = *report.given;
  if (report.assessed() && !trace.in_force.without_rules.empty()) {
    out["without_rules"] = trace.in_force.without_rules;
  }
  AddTrace(report, &out);
  if (report.assessed()) {
    out["base_parameters"] = {{"nominal", ModelParameters(trace.nominal)},
                              {"before", ModelParameters(trace.declared)},
                              {"after", ModelParameters(trace.corrected)}};
  }
  out["findings"] = Each(report.gate.findings, FindingJson);
  out["next_experiment"] = OrNull(NextExperiment(report));
  if (report.assessed()) {
    out["blocks"] = Blocks(trace);
    out["rows"] = RowsJson(trace);
    out["processing"] = Processing(report.processing);
  }
  out["seed"] = report.seed;
  out["seconds"] = report.seconds;
  if (trace.too_little) {
    out["too_little_data"] = {{"rule", trace.too_little->rule},
                              {"statistic", trace.too_little->statistic},
                              {"limit", trace.too_little->limit},
                              {"reason", trace.too_little->reason}};
  }
  return out;
}

Json CheckJson(const Report& report) {
  Json out = Start(report);
  out["schema"] = "sinew-check-data/1";
  out["verdict"] = VerdictWord(report.gate);
  out["sentence"] = VerdictSentence(report.gate);
  out.erase("outcome");
  out["recordings"] = RecordingsJson(report.train);
  out["faults"] = Each(report.gate.faults, FaultJson);
  out["findings"] = Each(report.gate.findings, FindingJson);
  out["rules"] = Each(report.gate.largest, [](const gate::Measurement& at) -> Json {
    return {{"rule", at.rule},
            {"statistic", at.statistic},
            {"limit", at.limit},
            {"signal", OrNull(at.signal)},
            {"recording", OrNull(at.recording)}};
  });
  out["seconds"] = report.seconds;
  return out;
}

}  // namespace sinew::report
