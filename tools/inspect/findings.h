// A finding of a check of `sinew doctor`, and its advice. Pure.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sinew::inspect {

enum class Severity {
  kOk,       // checked, nothing found
  kNote,     // could not be checked, or matters only in some uses
  kWarning,  // works, but not as well as it should
  kFault,    // something will not work
};

struct Finding {
  std::string check;  // "shared_memory"
  Severity severity = Severity::kOk;
  std::string text;    // what was found, with values and units
  std::string advice;  // what to do; empty for kOk
};

const char* SeverityName(Severity severity);
// 1 when there is a fault, with `strict` also for a warning; else 0.
int ExitCode(const std::vector<Finding>& findings, bool strict);
std::string FormatFindings(const std::vector<Finding>& findings);
nlohmann::ordered_json FindingsJson(const std::vector<Finding>& findings);

}  // namespace sinew::inspect
