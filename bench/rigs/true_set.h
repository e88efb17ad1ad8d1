// The cost of the search, against fits of the true set of effects (`run --true-set`):
// do intervals hold the truth, and how much larger is the held-out error?
//
// The truth of a parameter is what the same fit of the true set gives on the same recordings with a
// tenth of the noise (`make --noise 0.1`): where the declared structure is not the generator's
// (bristles, teeth, formulas of its own) no other value is to be found (pseudo-true, White 1982).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/rigs/figures.h"

namespace sinew::rig_bank {

// Options of `sinew close-loop` that give it the true set; empty: the case has none that could be
// given (outside of the catalogue, ignorance, faults).
std::vector<std::string> TrueSetOptions(const nlohmann::json& truth);
// An option with each effect of the catalogue that is there.
std::vector<std::string> EachEffect(const std::string& option, const nlohmann::json& truth);

// Intervals of the parameters in `report` that hold the values in `quiet`, and all of them; nothing
// where the two models have other terms.
std::pair<int, int> CountHeld(const nlohmann::json& report, const nlohmann::json& quiet);

// The same with the generator's values (truth.json) of declared parameters.
std::pair<int, int> CountHeldOfGenerator(const nlohmann::json& report, const nlohmann::json& truth);

// Held-out error of the report over that of the true set, in the balance of the first effect (the
// motion's without one). NaN where nothing was fitted.
double ErrorRatio(const nlohmann::json& report, const nlohmann::json& true_set,
                  const nlohmann::json& truth);

struct TrueSetFigures {
  std::vector<Figure> shares;
  std::vector<double> ratios;  // sorted
};
// Cases that are in all folders; `quiet` may be empty: no pseudo-true values.
TrueSetFigures CompareWithTrueSets(const std::filesystem::path& cases,
                                   const std::filesystem::path& reports,
                                   const std::filesystem::path& true_sets,
                                   const std::filesystem::path& quiet);
std::string TableOf(const TrueSetFigures& figures);

}  // namespace sinew::rig_bank
