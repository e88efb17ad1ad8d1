#include "bench/rigs/figures.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "bench/rigs/drawn/random.h"

namespace sinew::rig_bank {
namespace {

bool Holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<Named> Standing(const Outcome& outcome) {
  std::vector<Named> out;
  for (const Named& named : outcome.found) {
    if (named.confirmation != "refuted") out.push_back(named);
  }
  return out;
}

bool StandsFor(const Named& named, const TrueEffect& effect) {
  return Holds(effect.same_class, named.name) || Holds(named.rivals, effect.name);
}

bool StandsForAny(const Named& named, const Outcome& outcome) {
  return std::any_of(outcome.effects.begin(), outcome.effects.end(),
                     [&](const TrueEffect& effect) { return StandsFor(named, effect); });
}

bool SaysShift(const Outcome& outcome, const TrueEffect& effect) {
  return effect.absorbed && Holds(outcome.shift_causes, effect.name);
}

// What the residual of an effect outside of the catalogue may be said to follow.
bool NamesVariable(const Outcome& outcome) {
  static const std::map<std::string, std::vector<std::string>> variables = {
      {"cable_drag", {"position_rad", "position_m"}},
      {"bad_tooth", {"position_rad", "position_m", "motor_position_rad"}},
      {"slow_tilt", {"time_s", "position_rad"}},
      {"slipping_magnet", {"time_s", "position_rad"}},
      {"supply_sag", {"drive_input", "velocity_rad_s", "velocity_m_s", "motor_velocity_rad_s"}},
  };
  const auto found = variables.find(outcome.effects.front().name);
  return found != variables.end() && Holds(found->second, outcome.variable);
}

// Which cases a figure is counted on, and what is a hit.
struct Rule {
  const char* name;
  bool low_is_good;
  bool (*counts)(const Outcome&);
  bool (*hit)(const Outcome&);
};

bool OneEffect(const Outcome& o) { return o.kind == "effect" && o.effects.size() == 1; }
bool Fair(const Outcome& o) {
  return OneEffect(o) && o.effects[0].reached && o.effects[0].identifiable;
}
bool Moving(const Outcome& o) { return o.excitation != "locked"; }
bool StrongDesigned(const Outcome& o) {
  return OneEffect(o) && o.strength == "strong" && o.excitation == "designed";
}
bool Hidden(const Outcome& o) {
  return o.kind == "hidden" || (OneEffect(o) && !o.effects[0].identifiable);
}
bool Planted(const Outcome& o) { return o.kind == "planted"; }
bool Abstains(const Outcome& o) {
  return (o.verdict == "unexplained" || o.verdict == "none") && !Names(o);
}

// One effect, and what is named first is to hold it with 90 % at least.
bool SaysNinety(const Outcome& o) {
  const std::vector<Named> found = Standing(o);
  return OneEffect(o) && !found.empty() && found.front().probability >= 0.9;
}

const Rule kRules[] = {
    {"right class, strong, designed", false,
     [](const Outcome& o) { return Fair(o) && StrongDesigned(o); }, RightClass},
    {"  right name first", false, [](const Outcome& o) { return Fair(o) && StrongDesigned(o); },
     RightFirst},
    {"right class, weak, designed", false,
     [](const Outcome& o) { return Fair(o) && o.strength == "weak" && o.excitation == "designed"; },
     RightClass},
    {"right class, task", false, [](const Outcome& o) { return Fair(o) && o.excitation == "task"; },
     RightClass},
    {"right class, locked", false,
     [](const Outcome& o) { return Fair(o) && o.excitation == "locked"; }, RightClass},
    {"both of two", false,
     [](const Outcome& o) {
       return o.kind == "pair" &&
              std::all_of(o.effects.begin(), o.effects.end(),
                          [](const auto& e) { return e.reached && e.identifiable; });
     },
     [](const Outcome& o) {
       const std::vector<Named> found = Standing(o);
       return std::all_of(o.effects.begin(), o.effects.end(), [&](const TrueEffect& e) {
         return std::any_of(found.begin(), found.end(),
                            [&](const Named& n) { return StandsFor(n, e); });
       });
     }},
    {"wrong name beside or instead (one, two)", true,
     [](const Outcome& o) { return o.kind == "effect" || o.kind == "pair"; }, WrongName},
    {"alarm on plain recordings", true,
     [](const Outcome& o) { return o.kind == "plain" && Moving(o); }, Names},
    {"  of these with coloured noise", true,
     [](const Outcome& o) { return o.kind == "plain" && Moving(o) && o.coloured; }, Names},
    {"  with the motor locked", true,
     [](const Outcome& o) { return o.kind == "plain" && !Moving(o); }, Names},
    {"verdict none on plain recordings", false,
     [](const Outcome& o) { return o.kind == "plain" && Moving(o); },
     [](const Outcome& o) { return o.verdict == "none"; }},
    {"sets printed at 90 % and more hold the truth", false, SaysNinety, RightClass},
    {"planted at its detectable size: found", false, Planted, RightClass},
    {"structured ignorance named", true, [](const Outcome& o) { return o.kind == "ignorance"; },
     Names},
    {"outside: abstains", false,
     [](const Outcome& o) { return o.kind == "outside" && o.effects[0].reached; }, Abstains},
    {"outside: names the variable", false,
     [](const Outcome& o) { return o.kind == "outside" && o.effects[0].reached; },
     [](const Outcome& o) { return o.verdict == "unexplained" && NamesVariable(o); }},
    {"hidden: reported as not excited", false, Hidden,
     [](const Outcome& o) {
       return RightClass(o) || Holds(o.not_excited, o.effects[0].name) ||
              o.verdict == "too_little_data";
     }},
    {"hidden: wrong name", true, Hidden, WrongName},
    {"identifiable, listed as not excited", true, Fair,
     [](const Outcome& o) { return !RightClass(o) && Holds(o.not_excited, o.effects[0].name); }},
    {"identifiable, too little data", true, Fair,
     [](const Outcome& o) { return o.verdict == "too_little_data"; }},
    {"faults found", false, [](const Outcome& o) { return o.kind == "fault"; },
     [](const Outcome& o) {
       return o.verdict == "data_fault" || (o.fault == "spikes" && o.rows_left_out);
     }},
    {"false stops", true, [](const Outcome& o) { return o.kind != "fault"; },
     [](const Outcome& o) { return o.verdict == "data_fault"; }},
    {"no report", true, [](const Outcome&) { return true; },
     [](const Outcome& o) { return o.verdict == "missing"; }},
    {"excluded: strong designed, too small or not identifiable", true, StrongDesigned,
     [](const Outcome& o) { return !Fair(o); }},
};

// Names that reports print with a p, but for those of recordings with a fault of the log.
struct Printed {
  double p = 0.0;
  bool right = false, in_model = false;
};
std::vector<Printed> PrintedNames(const std::vector<Outcome>& outcomes) {
  std::vector<Printed> out;
  for (const Outcome& o : outcomes) {
    if (o.kind == "fault") continue;
    for (const Named& named : Standing(o)) out.push_back({named.p, StandsForAny(named, o), true});
    for (const Named& named : o.open) out.push_back({named.p, StandsForAny(named, o), false});
  }
  return out;
}

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace

std::pair<double, double> ClopperPearson(int hits, int trials) {
  if (hits < 0 || hits > trials) {
    throw std::invalid_argument("hits " + std::to_string(hits) + " of " + std::to_string(trials) +
                                ", expected 0 to the number of trials");
  }
  if (trials == 0) return {0.0, 1.0};
  // P(at least k hits of n) is the incomplete beta function I_p(k, n - k + 1).
  const double low = hits == 0 ? 0.0 : boost::math::ibeta_inv(hits, trials - hits + 1, 0.025);
  const double high = hits == trials ? 1.0 : boost::math::ibeta_inv(hits + 1, trials - hits, 0.975);
  return {low, high};
}

int Figure::hits() const {
  int sum = 0;
  for (const auto& [rig, counts] : by_rig) sum += counts.first;
  return sum;
}
int Figure::trials() const {
  int sum = 0;
  for (const auto& [rig, counts] : by_rig) sum += counts.second;
  return sum;
}

std::pair<double, double> Figure::ClusteredInterval() const {
  std::vector<std::pair<int, int>> rigs;
  for (const auto& [rig, counts] : by_rig) rigs.push_back(counts);
  if (rigs.empty()) return {0.0, 1.0};
  rigs::Random random(1, 0);
  std::vector<double> shares;
  for (int draw = 0; draw < 2000; ++draw) {
    int hit = 0, all = 0;
    for (std::size_t i = 0; i < rigs.size(); ++i) {
      const auto& [h, n] =
          rigs[static_cast<std::size_t>(random.Integer(0, static_cast<int>(rigs.size()) - 1))];
      hit += h;
      all += n;
    }
    shares.push_back(static_cast<double>(hit) / all);
  }
  return {Quantile(shares, 0.025), Quantile(shares, 0.975)};
}

bool Names(const Outcome& outcome) { return !Standing(outcome).empty(); }

bool RightClass(const Outcome& outcome) {
  if (outcome.effects.empty()) return false;
  const TrueEffect& effect = outcome.effects.front();
  if (SaysShift(outcome, effect)) return true;
  const std::vector<Named> found = Standing(outcome);
  return !found.empty() && StandsFor(found.front(), effect);
}

bool RightFirst(const Outcome& outcome) {
  if (outcome.effects.empty()) return false;
  const std::vector<Named> found = Standing(outcome);
  if (!found.empty() && found.front().name == outcome.effects.front().name) return true;
  return SaysShift(outcome, outcome.effects.front());
}

bool WrongName(const Outcome& outcome) {
  const std::vector<Named> found = Standing(outcome);
  return std::any_of(found.begin(), found.end(),
                     [&](const Named& named) { return !StandsForAny(named, outcome); });
}

Figures CountFigures(const std::vector<Outcome>& outcomes) {
  Figures out;
  for (const Rule& rule : kRules) {
    Figure figure{rule.name, rule.low_is_good, {}};
    for (const Outcome& outcome : outcomes) {
      if (!rule.counts(outcome)) continue;
      auto& [hits, trials] = figure.by_rig[outcome.rig];
      hits += rule.hit(outcome) ? 1 : 0;
      ++trials;
    }
    out.shares.push_back(figure);
  }
  std::vector<double> p, seconds;
  for (const Outcome& outcome : outcomes) {
    if (outcome.kind == "plain" && outcome.p_global) p.push_back(*outcome.p_global);
    if (outcome.seconds > 0.0) seconds.push_back(outcome.seconds);
  }
  std::sort(p.begin(), p.end());
  out.p_count = static_cast<int>(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double n = static_cast<double>(p.size()), at = static_cast<double>(i);
    out.p_ks = std::max({out.p_ks, std::abs(p[i] - at / n), std::abs((at + 1.0) / n - p[i])});
  }
  if (!p.empty()) out.p_ks_limit = 1.358 / std::sqrt(static_cast<double>(p.size()));
  out.seconds_median = Quantile(seconds, 0.5);
  out.seconds_95 = Quantile(seconds, 0.95);
  return out;
}

std::string TableOfShares(const std::vector<Figure>& shares) {
  std::string out =
      "figure                                                        hits of cases     %    exact "
      "95 %   by rig 95 %\n";
  char line[240];
  for (const Figure& figure : shares) {
    const int hits = figure.hits(), trials = figure.trials();
    if (trials == 0) continue;
    const auto [low, high] = ClopperPearson(hits, trials);
    const auto [from, to] = figure.ClusteredInterval();
    std::snprintf(line, sizeof line, "%-60s %5d of %5d  %5.1f  [%4.1f, %5.1f]  [%4.1f, %5.1f]%s\n",
                  figure.name.c_str(), hits, trials, 100.0 * hits / trials, 100.0 * low,
                  100.0 * high, 100.0 * from, 100.0 * to,
                  figure.low_is_good ? "  (low is good)" : "");
    out += line;
  }
  return out;
}

std::string ReliabilityOf(const std::vector<Outcome>& outcomes) {
  struct Row {
    std::string name;
    double from, to;
    bool open_too;
    int right = 0, all = 0;
    double sum = 0.0;  // of p
  };
  std::vector<Row> rows;
  for (int k = 0; k < 10; ++k) {
    rows.push_back({"p " + std::to_string(10 * k) + " to " + std::to_string(10 * k + 10) + " %",
                    0.1 * k, 0.1 * (k + 1), true});
  }
  rows.push_back({"named, p over 80 %", 0.8, 2.0, false});
  rows.push_back({"named, p over 95 %", 0.95, 2.0, false});
  for (const Printed& printed : PrintedNames(outcomes)) {
    for (Row& row : rows) {
      if (printed.p < row.from || printed.p >= row.to) continue;
      if (!printed.in_model && !row.open_too) continue;
      row.right += printed.right ? 1 : 0;
      ++row.all;
      row.sum += printed.p;
    }
  }
  std::string out;
  char line[160];
  for (const Row& row : rows) {
    if (row.all == 0) continue;
    const auto [low, high] = ClopperPearson(row.right, row.all);
    std::snprintf(line, sizeof line,
                  "  %-20s mean p %5.1f %%, right %4d of %4d  %5.1f %%  [%4.1f, %5.1f]\n",
                  row.name.c_str(), 100.0 * row.sum / row.all, row.right, row.all,
                  100.0 * row.right / row.all, 100.0 * low, 100.0 * high);
    out += line;
  }
  return out;
}

Calibration Calibrate(const std::vector<Outcome>& outcomes) {
  struct Point {
    double log_odds, right, weight;
  };
  std::vector<Point> points = {{0.0, 0.0, 0.5}, {0.0, 1.0, 0.5}};
  for (const Printed& printed : PrintedNames(outcomes)) {
    const double p = std::clamp(printed.p, 1e-6, 1.0 - 1e-6);
    points.push_back({std::log(p / (1.0 - p)), printed.right ? 1.0 : 0.0, 1.0});
  }
  Calibration out;
  out.names = static_cast<int>(points.size()) - 2;
  for (int step = 0; step < 50; ++step) {  // Newton; the likelihood is concave
    double g0 = 0, g1 = 0, h00 = 0, h01 = 0, h11 = 0;
    for (const Point& at : points) {
      const double q = 1.0 / (1.0 + std::exp(-(out.offset + out.slope * at.log_odds)));
      const double e = at.weight * (at.right - q), w = at.weight * std::max(1e-9, q * (1.0 - q));
      g0 += e, g1 += e * at.log_odds;
      h00 += w, h01 += w * at.log_odds, h11 += w * at.log_odds * at.log_odds;
    }
    const double det = h00 * h11 - h01 * h01;
    if (!(det > 1e-12)) break;
    out.offset += std::clamp((h11 * g0 - h01 * g1) / det, -1.0, 1.0);
    out.slope += std::clamp((h00 * g1 - h01 * g0) / det, -1.0, 1.0);
  }
  return out;
}

std::string PlantedTableOf(const std::vector<Outcome>& outcomes) {
  std::map<std::string, std::pair<int, int>> of_effect;  // found, trials
  for (const Outcome& outcome : outcomes) {
    if (!Planted(outcome)) continue;
    auto& [found, trials] = of_effect[outcome.effects.front().name];
    found += RightClass(outcome) ? 1 : 0;
    ++trials;
  }
  std::string out;
  char line[120];
  for (const auto& [name, counts] : of_effect) {
    std::snprintf(line, sizeof line, "  planted %-30s found %4d of %4d  %5.1f %%\n", name.c_str(),
                  counts.first, counts.second, 100.0 * counts.first / counts.second);
    out += line;
  }
  return out;
}

std::string TableOf(const Figures& figures) {
  std::string out = TableOfShares(figures.shares);
  char line[120];
  if (figures.p_count > 0) {
    std::snprintf(line, sizeof line,
                  "p_global on plain recordings: KS distance %.3f of %d (95 %% limit %.3f)\n",
                  figures.p_ks, figures.p_count, figures.p_ks_limit);
    out += line;
  }
  std::snprintf(line, sizeof line, "seconds a case: median %.1f, 95th percentile %.1f\n",
                figures.seconds_median, figures.seconds_95);
  return out + line;
}

std::string ConfusionOf(const std::vector<Outcome>& outcomes) {
  std::map<std::string, std::map<std::string, int>> taken;
  for (const Outcome& o : outcomes) {
    std::string truth = o.kind == "fault" ? "fault " + o.fault : o.kind == "plain" ? "plain" : "";
    for (const TrueEffect& e : o.effects) truth += (truth.empty() ? "" : " + ") + e.name;
    if (o.kind == "effect") truth += " " + o.strength + " " + o.excitation;
    std::string said = o.verdict;
    const std::vector<Named> found = Standing(o);
    for (std::size_t i = 0; i < found.size(); ++i)
      said = (i == 0 ? "" : said + "+") + found[i].name;
    if (found.empty() && !o.variable.empty()) said += ":" + o.variable;
    ++taken[truth][said];
  }
  std::string out;
  for (const auto& [truth, said] : taken) {
    out += truth + ":";
    for (const auto& [name, count] : said)
      out += "  " + name + (count > 1 ? " x" + std::to_string(count) : "");
    out += "\n";
  }
  return out;
}

nlohmann::json ToJson(const Figures& figures) {
  nlohmann::json out = nlohmann::json::array();
  for (const Figure& figure : figures.shares) {
    const int hits = figure.hits(), trials = figure.trials();
    const auto exact = ClopperPearson(hits, trials);
    const auto clustered = figure.ClusteredInterval();
    out.push_back({{"name", figure.name},
                   {"hits", hits},
                   {"trials", trials},
                   {"rigs", figure.by_rig.size()},
                   {"low_is_good", figure.low_is_good},
                   {"exact_95", {exact.first, exact.second}},
                   {"by_rig_95", {clustered.first, clustered.second}}});
  }
  return {{"figures", out},
          {"p_global",
           {{"count", figures.p_count}, {"ks", figures.p_ks}, {"ks_limit", figures.p_ks_limit}}},
          {"seconds_median", figures.seconds_median},
          {"seconds_95", figures.seconds_95}};
}

}  // namespace sinew::rig_bank
