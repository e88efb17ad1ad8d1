#include <cmath>
#include <nlohmann/json.hpp>

#include "components/base/types/json_text.h"
#include "components/model/gate/rules.h"
#include "components/model/report/file/recordings_json.h"
#include "components/model/report/file/report_file.h"

namespace sinew::report {

namespace {

using Json = nlohmann::ordered_json;

Json FindingsJson(const std::vector<identify::Finding>& findings) {
  Json out = Json::array();
  for (const identify::Finding& finding : findings) {
    out.push_back({{"name", finding.name},
                   {"text", finding.text},
                   {"value", finding.value},
                   {"unit", finding.unit}});
  }
  return out;
}

Json OrNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

}  // namespace

nlohmann::ordered_json FaultsJson(const std::vector<gate::Fault>& faults) {
  Json out = Json::array();
  for (const gate::Fault& fault : faults) {
    Json entry = {{"rule", fault.rule},
                  {"signal", OrNull(fault.signal)},
                  {"recording", OrNull(fault.recording)},
                  {"accepted", fault.accepted},
                  {"statistic", fault.statistic},
                  {"limit", fault.limit},
                  {"reason", fault.reason},
                  {"remedy", fault.remedy}};
    if (fault.last_row >= fault.first_row && !fault.recording.empty()) {
      entry["rows"] = {fault.first_row, fault.last_row};
      entry["time_s"] = {fault.from_s, fault.to_s};
    }
    out.push_back(std::move(entry));
  }
  return out;
}

std::string FormatCheckJson(const DataCheck& check) {
  Json out;
  out["schema"] = "sinew-check-data/1";
  out["verdict"] = VerdictWord(check.gate);
  out["sentence"] = VerdictSentence(check.gate);
  out["robot"] = check.robot;
  out["joint"] = check.joint;
  out["model"] = check.model_file;
  out["recordings"] = RecordingsJson(check.train);
  out["faults"] = FaultsJson(check.gate.faults);
  out["findings"] = FindingsJson(check.gate.findings);
  out["rules"] = Json::array();
  for (const gate::Measurement& at : check.gate.largest) {
    out["rules"].push_back({{"rule", at.rule},
                            {"statistic", at.statistic},
                            {"limit", at.limit},
                            {"signal", OrNull(at.signal)},
                            {"recording", OrNull(at.recording)}});
  }
  out["seconds"] = check.seconds;
  return types::JsonText(out, 2) + "\n";
}

namespace {

// A close-loop report in which nothing was traced: the keys of one with nothing found.
struct Untraced {
  std::string verdict, sentence, next_experiment;
  std::string robot, joint, model_file;
  const std::vector<Recording>&train, &held_out;
  const std::vector<gate::Fault>& faults;
  const std::vector<identify::Finding>& findings;
  std::uint64_t seed = 1;
  double seconds = 0.0;
};

Json UntracedJson(const Untraced& report) {
  Json out;
  out["schema"] = "sinew-close-loop/2";
  out["verdict"] = out["outcome"] = report.verdict;
  out["sentence"] = report.sentence;
  out["robot"] = report.robot;
  out["joint"] = report.joint;
  out["model"] = report.model_file;
  out["recordings"] = {{"train", RecordingsJson(report.train)},
                       {"held_out", RecordingsJson(report.held_out)}};
  out["faults"] = FaultsJson(report.faults);
  for (const char* key : {"effects", "open", "refuted", "events", "errors", "rises", "balances",
                          "rounds", "not_excited"}) {
    out[key] = Json::array();
  }
  out["not_excited_why"] = Json::object();
  out["unexplained"] = {{"variable", nullptr}};
  out["parameter_shift"] = Json::array();
  out["findings"] = FindingsJson(report.findings);
  out["next_experiment"] = OrNull(report.next_experiment);
  out["seed"] = report.seed;
  out["seconds"] = report.seconds;
  return out;
}

}  // namespace

std::string FormatDataFaultJson(const DataCheck& check) {
  return types::JsonText(UntracedJson({.verdict = VerdictWord(check.gate),
                                       .sentence = VerdictSentence(check.gate),
                                       .next_experiment = "",
                                       .robot = check.robot,
                                       .joint = check.joint,
                                       .model_file = check.model_file,
                                       .train = check.train,
                                       .held_out = check.held_out,
                                       .faults = check.gate.faults,
                                       .findings = check.gate.findings,
                                       .seed = check.seed,
                                       .seconds = check.seconds}),
                         2) +
         "\n";
}

std::string FormatTooLittleJson(const Report& report) {
  const trace::TooLittle& too_little = report.trace.too_little.value();
  Json out = UntracedJson({.verdict = VerdictWord(report.trace.verdict),
                           .sentence = VerdictSentence(report),
                           .next_experiment = NextExperiment(report),
                           .robot = report.robot,
                           .joint = report.trace.nominal.name,
                           .model_file = report.model_file,
                           .train = report.train,
                           .held_out = report.held_out,
                           .faults = report.faults,
                           .findings = report.findings,
                           .seed = report.seed,
                           .seconds = report.seconds});
  out["too_little_data"] = {{"rule", too_little.rule},
                            {"statistic", too_little.statistic},
                            {"limit", too_little.limit},
                            {"reason", too_little.reason}};
  return types::JsonText(out, 2) + "\n";
}

}  // namespace sinew::report
