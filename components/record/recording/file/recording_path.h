// FILE or FILE@START:END, as given on the command line.
#pragma once

#include <filesystem>
#include <optional>

#include "components/record/recording/time_range.h"

namespace sinew::recording {

struct RecordingPath {
  std::filesystem::path file;
  std::optional<TimeRange> range;  // nothing: the whole file

  bool IsMcap() const { return file.extension() == ".mcap"; }
};

// A file of that very name wins over a range. Throws UsageError naming file and range.
RecordingPath ParseRecordingPath(const std::filesystem::path& given);

}  // namespace sinew::recording
