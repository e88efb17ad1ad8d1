// Recordings of a pneumatic cylinder at constant pressure: CSV files with the columns time_s, x_mm,
// p_bar, F_N, as runs for the task `force`.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/types/run.h"

namespace sinew::reproduction {

// Every *.csv of the folder, in the order of their names; the first 15 rows (start-up) are left
// out. Throws UsageError naming the folder when it is absent or holds none, or the file and line.
std::vector<types::Run> ReadCylinder(const std::filesystem::path& folder);

}  // namespace sinew::reproduction
