#include "bench/rigs/outcome.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "bench/rigs/drawn/cases.h"

namespace sinew::rig_bank {
namespace {

using nlohmann::json;

std::vector<std::string> Names(const json& from, const char* key) {
  std::vector<std::string> out;
  if (!from.contains(key) || !from.at(key).is_array()) return out;
  for (const json& item : from.at(key)) {
    if (item.is_string())
      out.push_back(item.get<std::string>());
    else if (item.is_object() && item.contains("name"))
      out.push_back(item.at("name"));
    else if (item.is_object() && item.contains("effect"))
      out.push_back(item.at("effect"));
  }
  return out;
}

// Of the name and its rivals together.
double NamedProbability(const json& effect) {
  if (!effect.contains("posterior")) return 0.0;
  const std::vector<std::string> rivals = Names(effect, "rivals");
  double sum = 0.0;
  for (const json& entry : effect.at("posterior")) {
    const std::string name = entry.at("name");
    const bool named =
        name == effect.at("name") || std::find(rivals.begin(), rivals.end(), name) != rivals.end();
    if (named) sum += entry.at("probability").get<double>();
  }
  return sum;
}

std::string Text(const json& from, const char* key) {
  return from.contains(key) && from.at(key).is_string() ? from.at(key).get<std::string>() : "";
}

std::vector<Named> NamedIn(const json& report, const char* key) {
  std::vector<Named> out;
  for (const json& effect : report.value(key, json::array())) {
    const json said = effect.value("confirmation", json());
    const json score = effect.value("score", json());
    out.push_back({effect.at("name"), Names(effect, "rivals"),
                   said.is_object() ? Text(said, "verdict") : Text(effect, "confirmation"),
                   NamedProbability(effect), score.is_object() ? score.value("p", 0.0) : 0.0});
  }
  return out;
}

json ToJson(const std::vector<Named>& named) {
  json out = json::array();
  for (const Named& n : named) {
    out.push_back({{"name", n.name},
                   {"rivals", n.rivals},
                   {"confirmation", n.confirmation},
                   {"probability", n.probability},
                   {"p", n.p}});
  }
  return out;
}

std::vector<Named> NamedFrom(const json& lines) {
  std::vector<Named> out;
  for (const json& n : lines) {
    out.push_back({n.at("name"), n.at("rivals").get<std::vector<std::string>>(),
                   n.at("confirmation"), n.value("probability", 0.0), n.value("p", 0.0)});
  }
  return out;
}

json Read(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  return json::parse(in);
}

}  // namespace

Outcome MakeOutcome(const json& truth, const json& report) {
  Outcome out;
  out.name = truth.at("case");
  out.rig = truth.at("rig");
  out.kind = truth.at("kind");
  out.excitation = truth.at("excitation");
  out.strength = truth.at("strength");
  out.family = truth.at("family");
  out.fault = truth.at("fault");
  out.coloured = truth.at("coloured_noise");
  for (const json& effect : truth.at("effects")) {
    TrueEffect e;
    e.name = effect.at("name");
    e.variable = effect.at("variable");
    e.same_class = effect.at("class").get<std::vector<std::string>>();
    for (const auto& row : rigs::SameByDefinition()) {
      if (std::find(row.begin(), row.end(), e.name) != row.end()) {
        e.same_class.insert(e.same_class.end(), row.begin(), row.end());
      }
    }
    e.reached = effect.at("size_reached");
    e.identifiable = effect.at("identifiable");
    e.absorbed = effect.at("absorbed_by_refit");
    out.effects.push_back(e);
  }
  if (report.is_null()) {
    out.verdict = "missing";
    return out;
  }
  out.verdict = report.at("verdict");
  out.found = NamedIn(report, "effects");
  out.open = NamedIn(report, "open");
  if (report.contains("unexplained") && report.at("unexplained").is_object()) {
    out.variable = Text(report.at("unexplained"), "variable");
  }
  const std::vector<std::string> findings = Names(report, "findings");
  out.rows_left_out =
      std::find(findings.begin(), findings.end(), "left_out_rows") != findings.end();
  out.not_excited = Names(report, "not_excited");
  if (report.contains("parameter_shift")) {
    for (const json& shift : report.at("parameter_shift")) {
      for (const std::string& cause : Names(shift, "causes")) out.shift_causes.push_back(cause);
    }
  }
  if (report.contains("p_global") && report.at("p_global").is_number()) {
    out.p_global = report.at("p_global").get<double>();
  }
  return out;
}

json ToJson(const Outcome& o) {
  json effects = json::array();
  for (const TrueEffect& e : o.effects) {
    effects.push_back({{"name", e.name},
                       {"variable", e.variable},
                       {"class", e.same_class},
                       {"reached", e.reached},
                       {"identifiable", e.identifiable},
                       {"absorbed", e.absorbed}});
  }
  json out = {{"case", o.name},
              {"rig", o.rig},
              {"kind", o.kind},
              {"excitation", o.excitation},
              {"strength", o.strength},
              {"family", o.family},
              {"fault", o.fault},
              {"coloured", o.coloured},
              {"effects", effects},
              {"verdict", o.verdict},
              {"rows_left_out", o.rows_left_out},
              {"found", ToJson(o.found)},
              {"open", ToJson(o.open)},
              {"variable", o.variable},
              {"not_excited", o.not_excited},
              {"shift_causes", o.shift_causes},
              {"seconds", o.seconds}};
  if (o.p_global) out["p_global"] = *o.p_global;
  return out;
}

Outcome FromJson(const json& line) {
  Outcome o;
  o.name = line.at("case");
  o.rig = line.at("rig");
  o.kind = line.at("kind");
  o.excitation = line.at("excitation");
  o.strength = line.at("strength");
  o.family = line.at("family");
  o.fault = line.at("fault");
  o.coloured = line.at("coloured");
  for (const json& e : line.at("effects")) {
    o.effects.push_back({e.at("name"), e.at("variable"),
                         e.at("class").get<std::vector<std::string>>(), e.at("reached"),
                         e.at("identifiable"), e.at("absorbed")});
  }
  o.verdict = line.at("verdict");
  o.rows_left_out = line.value("rows_left_out", false);
  o.found = NamedFrom(line.at("found"));
  o.open = NamedFrom(line.value("open", json::array()));
  o.variable = line.at("variable");
  o.not_excited = line.at("not_excited").get<std::vector<std::string>>();
  o.shift_causes = line.at("shift_causes").get<std::vector<std::string>>();
  o.seconds = line.at("seconds");
  if (line.contains("p_global")) o.p_global = line.at("p_global").get<double>();
  return o;
}

std::vector<Outcome> ReadOutcomes(const std::filesystem::path& cases,
                                  const std::filesystem::path& reports) {
  std::vector<std::filesystem::path> folders;
  for (const auto& entry : std::filesystem::directory_iterator(cases)) {
    if (std::filesystem::exists(entry.path() / "truth.json")) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  std::vector<Outcome> out;
  for (const auto& folder : folders) {
    const auto report = reports / folder.filename() / "report.json";
    const auto run = reports / folder.filename() / "run.json";
    if (!std::filesystem::exists(report) && !std::filesystem::exists(run)) continue;
    out.push_back(MakeOutcome(Read(folder / "truth.json"),
                              std::filesystem::exists(report) ? Read(report) : json()));
    if (std::filesystem::exists(run)) {
      const json how = Read(run);
      out.back().seconds = how.value("seconds", 0.0);
      // A refusal of the data without a report counts as a data fault, a crash as missing.
      if (out.back().verdict == "missing" && how.value("refused", false))
        out.back().verdict = "data_fault";
    }
  }
  return out;
}

}  // namespace sinew::rig_bank
