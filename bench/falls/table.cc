#include "bench/falls/table.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <ostream>

namespace sinew::falls {

namespace {

constexpr double kMilli = 1e3;

template <class... Values>
void Line(std::ostream& out, const char* format, Values... values) {
  std::array<char, 512> line{};
  (void)std::snprintf(line.data(), line.size(), format, values...);
  out << line.data() << '\n';
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void PrintScenario(const Scenario& scenario, std::ostream& out) {
  out << scenario.seed << ' ' << KindName(scenario.kind) << ", "
      << ControllerName(scenario.controller);
  if (!scenario.text.empty()) out << ", " << scenario.text;
}

struct FallCounts {
  int runs = 0, found = 0, safe = 0;
  double descent_m_s = 0.0;
  std::vector<double> latency_ms;
};

struct SquatCounts {
  int runs = 0, alarms = 0;
  double tilt_rad = 0.0, share = 1.0;
};

}  // namespace

void Print(const FallRun& run, std::ostream& out) {
  PrintScenario(run.scenario, out);
  out << ": fell at " << *run.unguarded.fell_s << " s, ";
  if (run.guarded.fault_s) {
    out << "fault after " << kMilli * run.latency_s() << " ms (" << run.guarded.message << "), "
        << (run.guarded.safe ? "joints as declared" : "JOINTS NOT AS DECLARED");
  } else {
    out << "NO FAULT";
  }
  if (!run.found()) out << "  MISSED";
  out << '\n' << std::flush;
}

void Print(const SquatRun& run, std::ostream& out) {
  PrintScenario(run.scenario, out);
  const RunResult& result = run.guarded;
  out << ": tilt " << result.largest_tilt_rad / types::kDegree_rad << " deg, height "
      << result.least_share << " of nominal, detector from " << result.upright_s << " s on";
  if (result.fault_s) out << "  ALARM at " << *result.fault_s << " s: " << result.message;
  if (run.alarm() && !result.fault_s) out << "  DETECTOR STARTED TOO LATE";
  out << '\n' << std::flush;
}

bool PrintTable(const std::vector<FallRun>& falls, const std::vector<SquatRun>& squats,
                std::ostream& out) {
  bool good = true;
  std::map<Kind, FallCounts> by_kind;
  FallCounts all;
  for (const FallRun& run : falls) {
    for (FallCounts* counts : {&by_kind[run.scenario.kind], &all}) {
      ++counts->runs;
      counts->found += run.found();
      counts->safe += run.guarded.safe;
      counts->descent_m_s = std::max(counts->descent_m_s, run.guarded.largest_descent_m_s);
      if (run.guarded.fault_s) counts->latency_ms.push_back(kMilli * run.latency_s());
    }
    good = good && run.found() && run.guarded.safe;
  }
  const auto fall_line = [&out](std::string_view name, const FallCounts& counts) {
    const double worst_ms = counts.latency_ms.empty() ? 0.0
                                                      : *std::max_element(counts.latency_ms.begin(),
                                                                          counts.latency_ms.end());
    Line(out, "| %.*s | %d | %d | %.0f | %.0f | %d | %.2f |", static_cast<int>(name.size()),
         name.data(), counts.runs, counts.found, Median(counts.latency_ms), worst_ms, counts.safe,
         counts.descent_m_s);
  };
  out << "| falls | runs | found within " << kMilli * kRequired_s
      << " ms | latency, ms: median | worst | joints as declared | fastest "
         "descent, m/s |\n"
      << "| --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& [kind, counts] : by_kind) fall_line(KindName(kind), counts);
  fall_line("all", all);

  std::map<Kind, SquatCounts> squats_by_kind;
  SquatCounts all_squats;
  for (const SquatRun& run : squats) {
    const bool alarm = run.alarm();
    for (SquatCounts* counts : {&squats_by_kind[run.scenario.kind], &all_squats}) {
      ++counts->runs;
      counts->alarms += alarm;
      counts->tilt_rad = std::max(counts->tilt_rad, run.guarded.largest_tilt_rad);
      counts->share = std::min(counts->share, run.guarded.least_share);
    }
    good = good && !alarm;
  }
  out << "\n| squats | runs | alarms | largest tilt, deg | least height, of nominal |\n"
      << "| --- | --- | --- | --- | --- |\n";
  const auto squat_line = [&out](std::string_view name, const SquatCounts& counts) {
    Line(out, "| %.*s | %d | %d | %.1f | %.2f |", static_cast<int>(name.size()), name.data(),
         counts.runs, counts.alarms, counts.tilt_rad / types::kDegree_rad, counts.share);
  };
  for (const auto& [kind, counts] : squats_by_kind) squat_line(KindName(kind), counts);
  squat_line("all", all_squats);
  return good;
}

}  // namespace sinew::falls
