#include "tools/conform/report.h"

#include <algorithm>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

namespace sinew::conform {

namespace {

const char* VerdictText(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "FAIL";
    case Verdict::kNotApplicable:
      return "n/a";
  }
  return "";
}

const char* VerdictWord(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kFail:
      return "fail";
    case Verdict::kNotApplicable:
      return "not applicable";
  }
  return "";
}

}  // namespace

void Report::Add(std::string check, bool passed, std::string expected, std::string seen) {
  rows.push_back({std::move(check), passed ? Verdict::kPass : Verdict::kFail, std::move(expected),
                  std::move(seen)});
}

void Report::Skip(std::string check, std::string why) {
  rows.push_back({std::move(check), Verdict::kNotApplicable, "", std::move(why)});
}

bool Report::passed() const { return Count(Verdict::kFail) == 0; }

int Report::Count(Verdict verdict) const {
  return static_cast<int>(std::count_if(
      rows.begin(), rows.end(), [verdict](const Row& row) { return row.verdict == verdict; }));
}

void Print(const Report& report, std::ostream& out) {
  std::size_t width = 0;
  for (const Row& row : report.rows) width = std::max(width, row.check.size());
  for (const Row& row : report.rows) {
    out << std::left << std::setw(5) << VerdictText(row.verdict) << ' '
        << std::setw(static_cast<int>(width)) << row.check << "  " << row.seen << '\n';
    if (row.verdict == Verdict::kFail) {
      out << std::string(width + 8, ' ') << "expected: " << row.expected << '\n';
    }
  }
  std::ostringstream seconds;
  seconds << std::fixed << std::setprecision(1) << report.seconds;
  out << report.program << " as " << report.role << ": " << report.Count(Verdict::kPass)
      << " passed, " << report.Count(Verdict::kFail) << " failed, "
      << report.Count(Verdict::kNotApplicable) << " not applicable, " << seconds.str() << " s\n";
}

nlohmann::ordered_json ToJson(const Report& report) {
  nlohmann::ordered_json json = {{"role", report.role},
                                 {"program", report.program},
                                 {"passed", report.passed()},
                                 {"seconds", report.seconds},
                                 {"checks", nlohmann::ordered_json::array()}};
  for (const Row& row : report.rows) {
    json["checks"].push_back({{"check", row.check},
                              {"verdict", VerdictWord(row.verdict)},
                              {"expected", row.expected},
                              {"seen", row.seen}});
  }
  return json;
}

}  // namespace sinew::conform
