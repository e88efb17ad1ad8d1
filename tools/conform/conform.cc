#include "tools/conform/conform.h"

#include <algorithm>
#include <chrono>

#include "components/base/config/config.h"
#include "tools/conform/checks.h"
#include "tools/conform/real_time_run.h"
#include "tools/conform/role.h"

namespace sinew::conform {

std::vector<std::string> SubjectCommandLine(const Options& options, const std::string& name,
                                            node::TimeMode mode) {
  std::vector<std::string> line{options.program.string(),          "--name", name, "--domain",
                                std::to_string(options.domain_id), "--seed", "1"};
  if (mode == node::TimeMode::kLockstep) line.push_back("--lockstep");
  line.insert(line.end(), options.arguments.begin(), options.arguments.end());
  return line;
}

const std::vector<ProgramPart>& ProgramParts() {
  static const std::vector<ProgramPart> kParts = [] {
    std::vector<std::string> real_time;
    for (const RealTimePart& part : RealTimeParts()) {
      real_time.insert(real_time.end(), part.checks.begin(), part.checks.end());
    }
    return std::vector<ProgramPart>{
        {{"config_absent_file", "config_unknown_key", "config_missing"}, &CheckConfiguration},
        {real_time, &CheckRealTime},
        {{"lockstep_every_tick", "lockstep_repeats", "end_of_session", "sigint"}, &CheckLockstep}};
  }();
  return kParts;
}

std::vector<std::string> CheckNames() {
  std::vector<std::string> names;
  for (const ProgramPart& part : ProgramParts()) {
    names.insert(names.end(), part.checks.begin(), part.checks.end());
  }
  return names;
}

Report RunConform(const Options& options) {
  const Role role = FindRole(options.role);
  const std::vector<std::string> names = CheckNames();
  for (const std::string& name : options.only) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw UsageError("no check '" + name + "'; docs/how-to/conform.md lists them");
  }
  const auto began = std::chrono::steady_clock::now();
  Report report;
  report.role = options.role;
  report.program = options.program.filename().string();
  for (const ProgramPart& part : ProgramParts()) {
    if (part.IsWanted(options)) part.run(options, role, &report);
  }
  if (!options.only.empty()) {
    std::erase_if(report.rows, [&options](const Row& row) {
      return std::find(options.only.begin(), options.only.end(), row.check) == options.only.end();
    });
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return report;
}

}  // namespace sinew::conform
