// One case and the tracer's result.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sinew::rig_bank {

struct Named {
  std::string name;
  std::vector<std::string> rivals;
  std::string confirmation;  // empty: the report has none
  double probability = 0.0;  // of the name and its rivals together; 0: the report has none
  double p = 0.0;            // of the name by its facts; 0: the report has none
};

struct TrueEffect {
  std::string name, variable;
  std::vector<std::string> same_class;  // the name itself, its class in this rig, and by definition
  bool reached = false, identifiable = false, absorbed = false;
};

struct Outcome {
  // Truth.
  std::string name, kind, excitation, strength, family, fault;
  int rig = 0;
  bool coloured = false;
  std::vector<TrueEffect> effects;
  // Report.
  std::string verdict;         // "missing" where there is no report
  bool rows_left_out = false;  // by the data gate
  std::vector<Named> found, open;
  std::string variable;
  std::vector<std::string> not_excited, shift_causes;
  std::optional<double> p_global;
  double seconds = 0.0;
};

// Throws nlohmann::json::exception when a key that must be there is not.
Outcome MakeOutcome(const nlohmann::json& truth, const nlohmann::json& report);
nlohmann::json ToJson(const Outcome& outcome);
Outcome FromJson(const nlohmann::json& line);

// DIR/CASE/truth.json beside OUTDIR/CASE/report.json; a case that was asked and has no report
// is "missing", one that was not asked is left out.
std::vector<Outcome> ReadOutcomes(const std::filesystem::path& cases,
                                  const std::filesystem::path& reports);

}  // namespace sinew::rig_bank
