// Results of a gain search and of a pressure sweep as sections of a page, with their pictures, and
// as JSON. Pure text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "components/model/report/section.h"
#include "tools/tune_robot/gain_search.h"
#include "tools/tune_robot/pressure_sweep.h"

namespace sinew::tune {

// The error over each gain in stage 1 (Fig 6.17), and over all three in stage 2 (Fig 6.18).
std::vector<report::Picture> GainPictures(const GainSearchResult& result);
report::Section GainSection(const GainSearchResult& result, double seconds);
nlohmann::ordered_json GainJson(const GainSearchResult& result);

report::Section PressureSection(const PressureSweepConfig& config,
                                const std::vector<PressurePoint>& points, double seconds);
nlohmann::ordered_json PressureJson(const PressureSweepConfig& config,
                                    const std::vector<PressurePoint>& points);

}  // namespace sinew::tune
