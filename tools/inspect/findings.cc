#include "tools/inspect/findings.h"

#include <algorithm>

namespace sinew::inspect {

const char* SeverityName(Severity severity) {
  switch (severity) {
    case Severity::kOk:
      return "ok";
    case Severity::kNote:
      return "note";
    case Severity::kWarning:
      return "warning";
    case Severity::kFault:
      return "fault";
  }
  return "unknown";
}

int ExitCode(const std::vector<Finding>& findings, bool strict) {
  const Severity least = strict ? Severity::kWarning : Severity::kFault;
  return std::any_of(findings.begin(), findings.end(),
                     [least](const Finding& finding) { return finding.severity >= least; })
             ? 1
             : 0;
}

std::string FormatFindings(const std::vector<Finding>& findings) {
  constexpr std::size_t kSeverityWidth = 9;  // "warning" and a gap
  std::size_t text_column = 0;
  for (const Finding& finding : findings) {
    text_column = std::max(text_column, kSeverityWidth + finding.check.size() + 2);
  }
  std::string out;
  for (const Finding& finding : findings) {
    std::string line = SeverityName(finding.severity);
    line.resize(kSeverityWidth, ' ');
    line += finding.check;
    line.resize(text_column, ' ');
    out += line + finding.text + "\n";
    if (!finding.advice.empty()) {
      out += std::string(text_column, ' ') + "-> " + finding.advice + "\n";
    }
  }
  return out;
}

nlohmann::ordered_json FindingsJson(const std::vector<Finding>& findings) {
  auto rows = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    rows.push_back({{"check", finding.check},
                    {"severity", SeverityName(finding.severity)},
                    {"text", finding.text},
                    {"advice", finding.advice}});
  }
  return rows;
}

}  // namespace sinew::inspect
