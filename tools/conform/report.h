// Findings of the checks: a row each, as a table for people and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace sinew::conform {

enum class Verdict { kPass, kFail, kNotApplicable };

struct Row {
  std::string check;  // a name of checks.h
  Verdict verdict = Verdict::kNotApplicable;
  std::string expected;  // the rule
  std::string seen;      // of kNotApplicable: why
};

struct Report {
  std::string role, program;
  std::vector<Row> rows;
  double seconds = 0.0;

  void Add(std::string check, bool passed, std::string expected, std::string seen);
  void Skip(std::string check, std::string why);
  bool passed() const;  // nothing failed
  int Count(Verdict verdict) const;
};

void Print(const Report& report, std::ostream& out);
nlohmann::ordered_json ToJson(const Report& report);

}  // namespace sinew::conform
