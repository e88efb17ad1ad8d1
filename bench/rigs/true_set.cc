#include "bench/rigs/true_set.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <utility>

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

json ReadIfThere(const fs::path& path) {
  std::ifstream in(path);
  return in ? json::parse(in) : json();
}

// Parameters of the model that the report ends with; null: nothing was fitted.
json After(const json& report) {
  if (!report.is_object() || !report.contains("base_parameters")) return {};
  return report.at("base_parameters").at("after");
}

bool Holds(const json& parameter, double value) {
  const json& interval = parameter.at("interval_95");
  return interval.at(0).get<double>() <= value && value <= interval.at(1).get<double>();
}

bool HasInterval(const json& parameter) {
  return parameter.contains("interval_95") && parameter.at("half_width_95").is_number() &&
         parameter.at("half_width_95").get<double>() > 0.0;
}

double CorrectedError(const json& report, const std::string& balance) {
  json errors = report.value("held_out", json());
  if (balance == "K" || balance == "Q") {
    errors = json();
    for (const json& summary : report.value("balances", json::array())) {
      if (summary.at("balance") == balance) errors = summary.value("held_out", json());
    }
  }
  if (!errors.is_object() || !errors.at("corrected_rms").is_number()) return kNone;
  return errors.at("corrected_rms").get<double>();
}

void Add(const std::pair<int, int>& counts, int rig, Figure* figure) {
  if (counts.second == 0) return;
  auto& [hits, trials] = figure->by_rig[rig];
  hits += counts.first;
  trials += counts.second;
}

double At(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

std::vector<std::string> TrueSetOptions(const json& truth) {
  if (truth.at("kind") == "plain") return {"--effect", "none"};
  return EachEffect("--effect", truth);
}

std::vector<std::string> EachEffect(const std::string& option, const json& truth) {
  const std::string kind = truth.at("kind");
  std::vector<std::string> out;
  if (kind != "effect" && kind != "pair" && kind != "planted") return out;
  for (const json& effect : truth.at("effects")) {
    out.push_back(option);
    out.push_back(effect.at("name"));
  }
  return out;
}

std::pair<int, int> CountHeld(const json& report, const json& quiet) {
  const json own = After(report), truth = After(quiet);
  std::pair<int, int> out{0, 0};
  if (!own.is_object() || !truth.is_object() || own.size() != truth.size()) return out;
  for (const auto& [key, parameter] : own.items()) {
    if (!truth.contains(key)) return {0, 0};
  }
  for (const auto& [key, parameter] : own.items()) {
    if (!HasInterval(parameter)) continue;
    out.first += Holds(parameter, truth.at(key).at("value").get<double>()) ? 1 : 0;
    ++out.second;
  }
  return out;
}

std::pair<int, int> CountHeldOfGenerator(const json& report, const json& truth) {
  const json own = After(report);
  std::pair<int, int> out{0, 0};
  if (!own.is_object()) return out;
  for (const auto& [term, parameters] : truth.at("true_parameters").items()) {
    for (const auto& [key, value] : parameters.items()) {
      const std::string name = term + "." + key;
      if (!own.contains(name) || !HasInterval(own.at(name))) continue;
      out.first += Holds(own.at(name), value.at("true").get<double>()) ? 1 : 0;
      ++out.second;
    }
  }
  return out;
}

double ErrorRatio(const json& report, const json& true_set, const json& truth) {
  std::string balance = "M";
  if (!truth.at("effects").empty()) balance = truth.at("effects").front().at("balance");
  const double own = CorrectedError(report, balance), best = CorrectedError(true_set, balance);
  return best > 0.0 ? own / best : kNone;
}

TrueSetFigures CompareWithTrueSets(const fs::path& cases, const fs::path& reports,
                                   const fs::path& true_sets, const fs::path& quiet) {
  TrueSetFigures out;
  Figure true_held{"intervals of true sets hold the pseudo-true value", false, {}};
  Figure found_held{"  of found sets with the same terms", false, {}};
  Figure generator{"  of true sets, the generator's value", false, {}};
  for (const auto& entry : fs::directory_iterator(true_sets)) {
    const fs::path name = entry.path().filename();
    const json truth = ReadIfThere(cases / name / "truth.json");
    const json given = ReadIfThere(entry.path() / "report.json");
    const json found = ReadIfThere(reports / name / "report.json");
    if (truth.is_null() || given.is_null()) continue;
    const int rig = truth.at("rig");
    Add(CountHeldOfGenerator(given, truth), rig, &generator);
    if (!quiet.empty()) {
      const json exact = ReadIfThere(quiet / name / "report.json");
      Add(CountHeld(given, exact), rig, &true_held);
      Add(CountHeld(found, exact), rig, &found_held);
    }
    if (found.is_null()) continue;
    const double ratio = ErrorRatio(found, given, truth);
    if (std::isfinite(ratio)) out.ratios.push_back(ratio);
  }
  std::sort(out.ratios.begin(), out.ratios.end());
  out.shares = {true_held, found_held, generator};
  return out;
}

std::string TableOf(const TrueSetFigures& figures) {
  std::string out = TableOfShares(figures.shares);
  if (figures.ratios.empty()) return out;
  char line[160];
  std::snprintf(line, sizeof line,
                "held-out error over that of the true set, %zu cases: median %.3f, 95th "
                "percentile %.3f\n",
                figures.ratios.size(), At(figures.ratios, 0.5), At(figures.ratios, 0.95));
  return out + line;
}

}  // namespace sinew::rig_bank
