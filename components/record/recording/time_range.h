// A part of a recording: FILE@START:END on the command line, seconds on the recording's own clock.
// Pure; allocates.
#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "components/base/types/run.h"

namespace sinew::recording {

// Half open, so that @:30 and @30: share no row.
struct TimeRange {
  double start_s = -std::numeric_limits<double>::infinity();
  double end_s = std::numeric_limits<double>::infinity();  // the first instant left out
  std::string text;                                        // as given, "10:60"

  bool Overlaps(const TimeRange& other) const;
};

// "10:60", ":60", "10:" or ":" (everything). Throws std::invalid_argument that names the text.
TimeRange ParseTimeRange(std::string_view text);

// The rows of a run inside the range, as a run "NAME@TEXT" with a content hash of its own. Throws
// std::invalid_argument naming the recording, its clock and the range when no row is inside.
types::Run CutRun(const types::Run& run, const TimeRange& range);

}  // namespace sinew::recording
