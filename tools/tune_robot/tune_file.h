// Reads `schema: sinew-tune/1` and `schema: sinew-pressure-sweep/1` (docs/formats.md), and writes a
// controller with the gains that were found. Throws UsageError: one line naming file, line and key,
// also of the files that these name.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "components/base/config/fields.h"
#include "tools/tune_robot/gain_search.h"
#include "tools/tune_robot/pressure_sweep.h"

namespace sinew::tune {

struct TuneFile {
  RobotTrialConfig trial;
  GainSearchConfig search;        // threads: 1
  std::filesystem::path control;  // whose gains are sought
  // All files that the trials are made of, by what they are ("world"); with the file itself.
  std::map<std::string, std::filesystem::path> inputs;
};

inline constexpr char kTuneSchema[] = "sinew-tune/1";
void Describe(config::Fields& fields, TuneFile& file);
TuneFile LoadTune(const std::filesystem::path& path);

inline constexpr char kSweepSchema[] = "sinew-pressure-sweep/1";
void Describe(config::Fields& fields, PressureSweepConfig& sweep);  // threads: 1
PressureSweepConfig LoadPressureSweep(const std::filesystem::path& path);

// The text of `control` (sinew-control/1) with these gains in every joint, to stand in `folder`;
// comment: lines without '#', in place of the comment at its top. Throws UsageError when the file
// does not spell out the three gains, or the text does not read back with them.
std::string ControlText(const std::filesystem::path& control, const control::PidConfig& pid,
                        const std::filesystem::path& folder, const std::string& comment);

}  // namespace sinew::tune
