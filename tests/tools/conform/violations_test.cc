// Each check of `sinew conform` fails for a program that breaks its rule, and no other one does.
// Domains
// 67, 77, 78, 79.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "tests/tools/conform/run_all.h"
#include "tools/conform/conform.h"

namespace sinew::conform {
namespace {

const std::vector<int> kDomains = {67, 77, 78, 79};

struct Case {
  std::string violation;
  std::vector<std::string> only;  // checks that are made
  std::vector<std::string> failed;
};

const Case kCases[] = {
    {"", {}, {}},
    {"ignores_config", {"config_absent_file"}, {"config_absent_file"}},
    {"ignores_unknown_key", {"config_unknown_key"}, {"config_unknown_key"}},
    {"mute_without_config", {"config_missing"}, {"config_missing"}},
    {"never_starts", {"start"}, {"start"}},
    {"other_kind", {"start", "kind"}, {"kind"}},
    {"false_status", {"start", "idl_hash"}, {"idl_hash"}},
    {"takes_over_at_start", {"joins_below", "no_other_topics"}, {"joins_below", "no_other_topics"}},
    {"refuses_handover", {"joins_below", "handover"}, {"handover"}},
    {"other_type", {"types", "qos", "writes_its_topics"}, {"types", "qos"}},
    {"shared_ownership", {"types", "qos"}, {"qos"}},
    {"second_topic", {"writes_its_topics", "no_other_topics"}, {"no_other_topics"}},
    {"no_writer", {"writes_its_topics", "qos"}, {"writes_its_topics", "qos"}},
    {"mute", {"answers_every_tick"}, {"answers_every_tick"}},
    {"late", {"answers_within_a_cycle", "tick_and_session"}, {"answers_within_a_cycle"}},
    {"wrong_tick", {"tick_and_session"}, {"tick_and_session"}},
    {"wrong_joint_count", {"joint_count", "finite"}, {"joint_count"}},
    {"not_finite", {"joint_count", "finite", "no_torque_unarmed"}, {"finite"}},
    {"torque_when_disarmed", {"no_torque_unarmed", "finite"}, {"no_torque_unarmed"}},
    {"ignores_estop", {"no_torque_unarmed", "estop"}, {"estop"}},
    {"passes_nan_on", {"finite", "finite_from_broken_inputs"}, {"finite_from_broken_inputs"}},
    {"never_stale", {"goes_on_without_inputs", "marks_lost_inputs"}, {"marks_lost_inputs"}},
    {"stays_stale", {"marks_lost_inputs", "recovers"}, {"recovers"}},
    {"reads_alone", {"marks_lost_inputs", "refuses_other_sessions"}, {"refuses_other_sessions"}},
    {"reads_alone", {"malformed_goes_on", "malformed_counted"}, {"malformed_counted"}},
    {"waits_for_inputs",
     {"answers_every_tick", "goes_on_without_inputs"},
     {"goes_on_without_inputs"}},
    {"launders_origin", {"origin"}, {"origin"}},
    {"keeps_session", {"new_session"}, {"new_session"}},
    {"crashes_on_malformed", {"malformed_goes_on"}, {"malformed_goes_on"}},
    {"never_stops", {"sigterm"}, {"sigterm"}},
    {"never_stops", {"sigint", "lockstep_every_tick"}, {"sigint"}},
    {"random", {"lockstep_every_tick", "lockstep_repeats"}, {"lockstep_repeats"}},
    {"mute", {"lockstep_every_tick"}, {"lockstep_every_tick"}},
    {"ignores_last_tick", {"end_of_session", "sigint"}, {"end_of_session"}},
};

Options ToOptions(const Case& violation, const std::filesystem::path& config) {
  Options options;
  options.role = "control";
  options.program = std::string(SINEW_TEST_BIN_DIR) + "/conform_violator";
  options.arguments = {"--config", config.string()};
  if (!violation.violation.empty()) {
    options.arguments.insert(options.arguments.end(), {"--violate", violation.violation});
  }
  options.only = violation.only;
  return options;
}

std::vector<std::string> FailedChecks(const Report& report) {
  std::vector<std::string> failed;
  for (const Row& row : report.rows) {
    if (row.verdict == Verdict::kFail) failed.push_back(row.check);
  }
  std::sort(failed.begin(), failed.end());
  return failed;
}

TEST(Violations, AreFoundByTheirCheckAlone) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path config = folder.path() / "violator.yaml";
  std::ofstream(config) << "schema: sinew-violator/1\n";
  std::vector<Options> all;
  for (const Case& violation : kCases) all.push_back(ToOptions(violation, config));
  const auto expected = [](std::size_t i) {
    std::vector<std::string> failed = kCases[i].failed;
    std::sort(failed.begin(), failed.end());
    return failed;
  };
  const std::vector<Report> reports =
      RunAll(all, kDomains, [&expected](std::size_t i, const Report& report) {
        return FailedChecks(report) == expected(i);
      });
  for (std::size_t i = 0; i < reports.size(); ++i) {
    std::ostringstream table;
    Print(reports[i], table);
    const std::size_t rows = kCases[i].only.empty() ? CheckNames().size() : kCases[i].only.size();
    EXPECT_EQ(FailedChecks(reports[i]), expected(i)) << kCases[i].violation << '\n' << table.str();
    EXPECT_EQ(reports[i].rows.size(), rows) << kCases[i].violation << '\n' << table.str();
  }
}

// A check that no case above makes fail proves nothing.
TEST(ConformChecks, EachHasAProgramThatFailsIt) {
  std::vector<std::string> never;
  for (const std::string& name : CheckNames()) {
    bool found = false;
    for (const Case& violation : kCases) {
      found = found || std::find(violation.failed.begin(), violation.failed.end(), name) !=
                           violation.failed.end();
    }
    if (!found) never.push_back(name);
  }
  EXPECT_TRUE(never.empty()) << ::testing::PrintToString(never);
}

}  // namespace
}  // namespace sinew::conform
