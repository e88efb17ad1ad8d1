#include "components/model/report/file/recordings_json.h"

#include <nlohmann/json.hpp>

namespace sinew::report {

nlohmann::ordered_json RecordingsJson(const std::vector<Recording>& recordings) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Recording& recording : recordings) {
    out.push_back({{"name", recording.name},
                   {"content_hash", recording.content_hash},
                   {"rows", recording.rows},
                   {"duration_s", recording.duration_s}});
  }
  return out;
}

}  // namespace sinew::report
