// Rows that were interpolated between measured ones, as when a file is brought to a higher rate.
// They hold nothing new, smooth what was measured, and make white noise look coloured.
//
// A row is interpolated when every signal lies on the straight line between its neighbours, to
// within rounding. Held values and coarse converters do so at times; files of a higher rate do so
// in a pattern: of m rows (2 to 10) m - 1 always, one never. Pure; allocates.
#pragma once

#include <vector>

#include "components/base/types/run.h"

namespace sinew::identify {

// The recording with these of its rows alone, in their order. All else is as it was: the content
// hash names what was recorded.
types::Run WithRows(types::Run run, const std::vector<Eigen::Index>& rows);

// The measured rows alone; `interpolated_rows` says how many were left out: none of 0 rows, none of
// held positions.
types::Run WithoutInterpolatedRows(types::Run run);

}  // namespace sinew::identify
