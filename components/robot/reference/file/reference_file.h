// Reads `schema: sinew-reference/1` (docs/participants/reference.md). Throws UsageError.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/reference/robot_reference.h"

namespace sinew::reference {

inline constexpr char kSchema[] = "sinew-reference/1";

struct LoadedReference {
  RobotReferenceConfig config;
  // For the log: what was drawn in to keep the limits, a line per joint that was.
  std::vector<std::string> notes;
  // Joints of a squat in their order, the driven ones of the URDF. Else empty.
  std::vector<std::string> joint_names;
};

void Describe(config::Fields& fields, LoadedReference& loaded);
LoadedReference LoadReference(const std::filesystem::path& path);

// Columns of a CSV file with a header line; times in s. Throws UsageError naming file, line and
// column.
struct CsvTrajectory {
  std::vector<double> time_s;
  std::vector<double> position_rad;
};
CsvTrajectory ReadTrajectoryCsv(const std::filesystem::path& path, const std::string& time_column,
                                const std::string& position_column);

}  // namespace sinew::reference
