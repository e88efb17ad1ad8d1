#include "tests/bank/figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "components/identify/statistics.h"

namespace sinew::bank {
namespace {

using nlohmann::json;
using surrogate::ExcitationKind;

bool Holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

const char* WordOf(Strength strength) { return strength == Strength::kWeak ? "weak" : "strong"; }
const char* WordOf(ExcitationKind kind) {
  return kind == ExcitationKind::kTask ? "task" : "designed";
}

std::string CellOf(const Outcome& outcome) {
  return outcome.what.effects.front() + "/" + WordOf(outcome.what.strength) + "/" +
         WordOf(outcome.what.excitation);
}

bool IsSwallowed(const Outcome& outcome) {
  return FindSize(outcome.what.effects.front(), outcome.what.excitation).sizing == Sizing::kShift;
}

std::vector<std::string> ClassOfCase(const std::string& effect, ExcitationKind excitation) {
  std::vector<std::string> out = FindSize(effect, excitation).rivals;
  out.push_back(effect);
  return out;
}

// log of the probability of exactly k of n.
double LogBinomial(int k, int n, double p) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(p) +
         (n - k) * std::log1p(-p);
}

double AtLeast(int hits, int trials, double p) {
  double sum = 0.0;
  for (int k = hits; k <= trials; ++k) sum += std::exp(LogBinomial(k, trials, p));
  return sum;
}

// p at which the rising function reaches the value.
template <class Function>
double Solve(Function rising, double value) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (rising(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// What an outside effect's residual may be said to follow.
std::vector<std::string> VariablesOf(const std::string& effect) {
  if (effect == "cable_drag") return {"position_rad"};
  if (effect == "bad_tooth") return {"motor_position_rad", "position_rad"};
  if (effect == "slow_tilt") return {"time_s", "position_rad"};
  if (effect == "slipping_magnet") return {"time_s", "position_rad"};
  return {};
}

bool OutsideRight(const Outcome& outcome) {
  const std::string& effect = outcome.what.effects.front();
  if (effect == "supply_sag") return outcome.verdict == "none";
  return outcome.verdict == "unexplained" && Holds(VariablesOf(effect), outcome.variable);
}

bool BothNamed(const Outcome& outcome) {
  return std::all_of(
      outcome.what.effects.begin(), outcome.what.effects.end(), [&](const std::string& effect) {
        const std::vector<std::string> same = ClassOfCase(effect, outcome.what.excitation);
        return std::any_of(outcome.found.begin(), outcome.found.end(), [&](const Found& found) {
          return Holds(same, found.name) || Holds(found.rivals, effect);
        });
      });
}

}  // namespace

std::pair<double, double> ClopperPearson(int hits, int trials) {
  if (hits < 0 || hits > trials) {
    throw std::invalid_argument("hits " + std::to_string(hits) + " of " + std::to_string(trials) +
                                ", expected 0 to the number of trials");
  }
  if (trials == 0) return {0.0, 1.0};
  const double low =
      hits == 0 ? 0.0 : Solve([&](double p) { return AtLeast(hits, trials, p); }, 0.025);
  const double high =
      hits == trials ? 1.0 : Solve([&](double p) { return AtLeast(hits + 1, trials, p); }, 0.975);
  return {low, high};
}

bool NamedFirst(const Outcome& outcome) {
  const std::string& effect = outcome.what.effects.front();
  if (!outcome.found.empty() && outcome.found.front().name == effect) return true;
  return IsSwallowed(outcome) && Holds(outcome.shift_causes, effect);
}

bool NamedItsClass(const Outcome& outcome) {
  if (NamedFirst(outcome)) return true;
  if (outcome.found.empty()) return false;
  const std::string& effect = outcome.what.effects.front();
  return Holds(ClassOfCase(effect, outcome.what.excitation), outcome.found.front().name) ||
         Holds(outcome.found.front().rivals, effect);
}

Figures CountFigures(const std::vector<Outcome>& outcomes) {
  // Cells in which even the true structure cannot be told.
  std::map<std::string, std::pair<int, int>> cells;  // significant, all
  for (const Outcome& outcome : outcomes) {
    if (outcome.what.kind != Kind::kEffect || !(outcome.sealed_oracle > 0.0)) continue;
    if (IsSwallowed(outcome)) continue;
    auto& [significant, all] = cells[CellOf(outcome)];
    significant += outcome.oracle_significant ? 1 : 0;
    ++all;
  }
  Figures out;
  for (const auto& [cell, counts] : cells) {
    if (2 * counts.first < counts.second) out.hidden_cells.push_back(cell);
  }

  Share strong{.name = "right effect first, strong", .goal = "95 %"};
  Share weak{.name = "right effect first, weak", .goal = "88 %"};
  Share first_of_all{.name = "  of all, with rivals in the design", .goal = ""};
  Share same_class{.name = "right class", .goal = "97 %"};
  Share alarm{.name = "alarm without an effect", .goal = "at most 1 %", .low_is_good = true};
  Share coloured{.name = "  of these with coloured noise", .goal = "", .low_is_good = true};
  Share wrong{.name = "confident wrong name", .goal = "at most 2 %", .low_is_good = true};
  Share outside{.name = "outside the catalogue: right", .goal = "85 %"};
  Share hidden{.name = "hidden by the excitation: says so", .goal = "95 %"};
  Share task{.name = "task excitation: right class", .goal = ""};
  Share both{.name = "both of two effects", .goal = "75 %"};
  Share covered{.name = "interval holds the parameter", .goal = "92-98 %"};
  std::vector<double> ratios, errors;
  double rivals = 0.0;
  int named = 0;
  for (const Outcome& outcome : outcomes) {
    const Kind kind = outcome.what.kind;
    if (kind == Kind::kNone) {
      const bool alarmed = outcome.verdict != "none";
      ++alarm.trials;
      alarm.hits += alarmed ? 1 : 0;
      if (outcome.what.coloured) {
        ++coloured.trials;
        coloured.hits += alarmed ? 1 : 0;
      }
      continue;
    }
    if (kind == Kind::kPair) {
      ++both.trials;
      both.hits += BothNamed(outcome) ? 1 : 0;
      continue;
    }
    if (kind == Kind::kOutside) {
      ++outside.trials;
      outside.hits += OutsideRight(outcome) ? 1 : 0;
      continue;
    }
    const bool is_hidden = Holds(out.hidden_cells, CellOf(outcome));
    const bool right_class = NamedItsClass(outcome);
    if (is_hidden) {
      ++hidden.trials;
      hidden.hits +=
          right_class || Holds(outcome.not_excited, outcome.what.effects.front()) ? 1 : 0;
    }
    ++wrong.trials;
    wrong.hits += outcome.verdict == "effect" && !right_class ? 1 : 0;
    if (is_hidden) continue;
    if (outcome.what.excitation == ExcitationKind::kTask) {
      ++task.trials;
      task.hits += right_class ? 1 : 0;
      continue;
    }
    // Where another effect predicts the same in the design without noise, only the class can be
    // told.
    const bool named_first = NamedFirst(outcome);
    if (FindSize(outcome.what.effects.front(), outcome.what.excitation).rivals.empty()) {
      Share& first = outcome.what.strength == Strength::kWeak ? weak : strong;
      ++first.trials;
      first.hits += named_first ? 1 : 0;
    }
    ++first_of_all.trials;
    first_of_all.hits += named_first ? 1 : 0;
    ++same_class.trials;
    same_class.hits += right_class ? 1 : 0;
    if (outcome.sealed_oracle > 0.0 && !IsSwallowed(outcome)) {
      ratios.push_back(outcome.sealed_after / outcome.sealed_oracle);
    }
    if (!outcome.found.empty()) {
      rivals += static_cast<double>(outcome.found.front().rivals.size());
      ++named;
    }
    if (std::isfinite(outcome.truth) && outcome.truth != 0.0) {
      errors.push_back(std::abs(outcome.value / outcome.truth - 1.0));
      if (std::isfinite(outcome.half_width)) {
        ++covered.trials;
        covered.hits += std::abs(outcome.value - outcome.truth) <= outcome.half_width ? 1 : 0;
      }
    }
  }
  out.shares = {strong, weak,    first_of_all, same_class, alarm,   coloured,
                wrong,  outside, hidden,       both,       covered, task};
  const auto quantile = [](const std::vector<double>& values, double p) {
    return values.empty() ? std::numeric_limits<double>::quiet_NaN()
                          : identify::Quantile(values, p);
  };
  out.values = {
      {"sealed error over the oracle's, median", "1.05", quantile(ratios, 0.5),
       static_cast<int>(ratios.size())},
      {"sealed error over the oracle's, 95th percentile", "1.20", quantile(ratios, 0.95),
       static_cast<int>(ratios.size())},
      {"parameter error, median", "5 %", 100.0 * quantile(errors, 0.5),
       static_cast<int>(errors.size())},
      {"rivals named, mean", "at most 2", named > 0 ? rivals / named : 0.0, named},
  };
  return out;
}

std::string FormatFigures(const Figures& figures) {
  std::string out;
  char line[200];
  for (const Share& share : figures.shares) {
    if (share.trials == 0) continue;
    const auto [low, high] = ClopperPearson(share.hits, share.trials);
    std::snprintf(line, sizeof line, "%-36s %5d of %5d  %5.1f %%  [%5.1f, %5.1f]  goal %s\n",
                  share.name.c_str(), share.hits, share.trials, 100.0 * share.hits / share.trials,
                  100.0 * low, 100.0 * high, share.goal.empty() ? "-" : share.goal.c_str());
    out += line;
  }
  for (const Value& value : figures.values) {
    if (value.count == 0) continue;
    std::snprintf(line, sizeof line, "%-48s %7.3f  (of %d)  goal %s\n", value.name.c_str(),
                  value.value, value.count, value.goal.c_str());
    out += line;
  }
  for (const std::string& cell : figures.hidden_cells) out += "hidden: " + cell + "\n";
  return out;
}

std::string FormatConfusion(const std::vector<Outcome>& outcomes) {
  // What was named first, by truth.
  std::map<std::string, std::map<std::string, int>> counts;
  for (const Outcome& outcome : outcomes) {
    std::string truth;
    switch (outcome.what.kind) {
      case Kind::kNone:
        truth = std::string("none/") + (outcome.what.coloured ? "coloured/" : "white/") +
                WordOf(outcome.what.excitation);
        break;
      case Kind::kPair:
        truth = outcome.what.effects[0] + "+" + outcome.what.effects[1];
        break;
      default:
        truth = CellOf(outcome);
    }
    std::string said;
    if (outcome.what.kind == Kind::kPair) {
      for (const Found& found : outcome.found) said += (said.empty() ? "" : "+") + found.name;
    } else if (!outcome.found.empty()) {
      said = outcome.found.front().name;
      if (outcome.what.kind == Kind::kEffect && said != outcome.what.effects.front() &&
          NamedItsClass(outcome)) {
        said += "(class)";
      }
    } else if (outcome.what.kind == Kind::kEffect && NamedFirst(outcome)) {
      said = "shift";
    }
    if (said.empty()) {
      said = outcome.verdict == "unexplained" ? "?" + outcome.variable : "none";
      if (outcome.what.kind == Kind::kEffect &&
          Holds(outcome.not_excited, outcome.what.effects.front())) {
        said += "(says hidden)";
      }
    }
    ++counts[truth][said];
  }
  std::string out;
  for (const auto& [truth, row] : counts) {
    std::vector<std::pair<int, std::string>> sorted;
    for (const auto& [said, count] : row) sorted.emplace_back(-count, said);
    std::sort(sorted.begin(), sorted.end());
    char head[80];
    std::snprintf(head, sizeof head, "%-46s", truth.c_str());
    out += head;
    for (const auto& [count, said] : sorted) out += " " + std::to_string(-count) + " " + said + ";";
    out += "\n";
  }
  return out;
}

std::string ToJson(const Outcome& o) {
  json found = json::array();
  for (const Found& f : o.found) {
    found.push_back({{"name", f.name}, {"rivals", f.rivals}, {"swallowed", f.swallowed}});
  }
  const auto number = [](double value) { return std::isfinite(value) ? json(value) : json(); };
  return json{{"kind", static_cast<int>(o.what.kind)},
              {"effects", o.what.effects},
              {"strength", WordOf(o.what.strength)},
              {"excitation", WordOf(o.what.excitation)},
              {"seed", o.what.seed},
              {"coloured", o.what.coloured},
              {"verdict", o.verdict},
              {"found", found},
              {"variable", o.variable},
              {"not_excited", o.not_excited},
              {"shift_causes", o.shift_causes},
              {"sealed_before_Nm", o.sealed_before},
              {"sealed_after_Nm", o.sealed_after},
              {"sealed_oracle_Nm", o.sealed_oracle},
              {"oracle_significant", o.oracle_significant},
              {"value", number(o.value)},
              {"truth", number(o.truth)},
              {"half_width", number(o.half_width)},
              {"seconds", o.seconds}}
      .dump();
}

Outcome FromJson(const std::string& line) {
  try {
    const json j = json::parse(line);
    const auto number = [&](const char* key) {
      return j.at(key).is_null() ? std::numeric_limits<double>::quiet_NaN()
                                 : j.at(key).get<double>();
    };
    Outcome o;
    o.what.kind = static_cast<Kind>(j.at("kind").get<int>());
    o.what.effects = j.at("effects").get<std::vector<std::string>>();
    o.what.strength = j.at("strength") == "weak" ? Strength::kWeak : Strength::kStrong;
    o.what.excitation =
        j.at("excitation") == "task" ? ExcitationKind::kTask : ExcitationKind::kDesigned;
    o.what.seed = j.at("seed").get<std::uint64_t>();
    o.what.coloured = j.at("coloured").get<bool>();
    o.verdict = j.at("verdict").get<std::string>();
    for (const json& f : j.at("found")) {
      o.found.push_back({f.at("name").get<std::string>(),
                         f.at("rivals").get<std::vector<std::string>>(),
                         f.at("swallowed").get<bool>()});
    }
    o.variable = j.at("variable").get<std::string>();
    o.not_excited = j.at("not_excited").get<std::vector<std::string>>();
    o.shift_causes = j.at("shift_causes").get<std::vector<std::string>>();
    o.sealed_before = number("sealed_before_Nm");
    o.sealed_after = number("sealed_after_Nm");
    o.sealed_oracle = number("sealed_oracle_Nm");
    o.oracle_significant = j.at("oracle_significant").get<bool>();
    o.value = number("value");
    o.truth = number("truth");
    o.half_width = number("half_width");
    o.seconds = number("seconds");
    return o;
  } catch (const json::exception& error) {
    throw std::invalid_argument(std::string("not an outcome of the bank: ") + error.what());
  }
}

std::string FiguresToJson(const Figures& figures) {
  json out;
  for (const Share& share : figures.shares) {
    const auto [low, high] = ClopperPearson(share.hits, share.trials);
    out["shares"].push_back({{"name", share.name},
                             {"goal", share.goal},
                             {"hits", share.hits},
                             {"trials", share.trials},
                             {"lower_95", low},
                             {"upper_95", high}});
  }
  for (const Value& value : figures.values) {
    out["values"].push_back({{"name", value.name},
                             {"goal", value.goal},
                             {"value", std::isfinite(value.value) ? json(value.value) : json()},
                             {"count", value.count}});
  }
  out["hidden_cells"] = figures.hidden_cells;
  return out.dump(1);
}

}  // namespace sinew::bank
