// Every participant and stand-in of the project keeps the contract of its role. Domain 68.
#include "tools/conform/conform.h"

#include <gtest/gtest.h>

#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace sinew::conform {
namespace {

constexpr int kDomain = 68;
const std::string kRig = SINEW_SOURCE_DIR "/robots/rig/";

struct Subject {
  std::string role, program, config;  // config: in robots/rig; empty: none
  std::string label;                  // of several configurations
};
std::ostream& operator<<(std::ostream& out, const Subject& subject) {
  return out << subject.program << ' ' << subject.config;
}

const Subject kSubjects[] = {
    {"pneumatics", "sinew-pneumatics", "pneumatics.yaml", ""},
    {"pneumatics", "sinew-ideal-pressure", "pneumatics.yaml", ""},
    {"regime", "sinew-regime", "regime.yaml", ""},
    {"regime", "sinew-regime", "regime_active.yaml", "active"},
    {"regime", "sinew-regime-truth", "", ""},
    {"reference", "sinew-reference", "reference_benchmark.yaml", ""},
    {"esn", "sinew-esn", "esn.yaml", ""},
    {"esn", "sinew-esn", "esn_adaptive.yaml", "adaptive"},
    {"esn", "sinew-inverse-dynamics", "esn_model.yaml", ""},
    {"rls", "sinew-rls", "rls.yaml", ""},
    {"rls", "sinew-frozen-readout", "rls.yaml", ""},
    {"control", "sinew-control", "control_pid_model.yaml", ""},
    {"control", "sinew-control", "control_pid_esn.yaml", "esn"},
    {"control", "sinew-control", "control_position.yaml", "position"},
    {"residual", "sinew-residual", "residual.yaml", ""},
};

class Conform : public ::testing::TestWithParam<Subject> {};

TEST_P(Conform, KeepsTheContractOfItsRole) {
  const Subject& subject = GetParam();
  Options options;
  options.role = subject.role;
  options.program = std::string(SINEW_BIN_DIR) + "/" + subject.program;
  if (!subject.config.empty()) options.arguments = {"--config", kRig + subject.config};
  options.domain_id = kDomain;
  const Report report = RunConform(options);
  std::ostringstream table;
  Print(report, table);
  EXPECT_TRUE(report.passed()) << table.str();
  EXPECT_EQ(report.rows.size(), CheckNames().size()) << table.str();
  std::printf("%s", table.str().c_str());
}

std::string NameOf(const ::testing::TestParamInfo<Subject>& info) {
  std::string name = info.param.program.substr(std::string("sinew-").size());
  if (!info.param.label.empty()) name += "_" + info.param.label;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
INSTANTIATE_TEST_SUITE_P(Programs, Conform, ::testing::ValuesIn(kSubjects), NameOf);

}  // namespace
}  // namespace sinew::conform
