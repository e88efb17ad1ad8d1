#include "components/record/recording/file/recording_path.h"

#include "components/base/config/config.h"

namespace sinew::recording {

RecordingPath ParseRecordingPath(const std::filesystem::path& given) {
  std::error_code error;
  const std::string text = given.string();
  const std::size_t at = text.rfind('@');
  const bool in_the_name = at != std::string::npos && text.find('/', at) == std::string::npos;
  if (!in_the_name || std::filesystem::exists(given, error)) return {given, std::nullopt};
  RecordingPath out;
  out.file = text.substr(0, at);
  try {
    out.range = ParseTimeRange(std::string_view(text).substr(at + 1));
  } catch (const std::invalid_argument& wrong) {
    // Without such a file it is a name with an @ that is not there.
    if (!std::filesystem::exists(out.file, error)) return {given, std::nullopt};
    throw UsageError(out.file.string() + ": " + wrong.what());
  }
  return out;
}

}  // namespace sinew::recording
