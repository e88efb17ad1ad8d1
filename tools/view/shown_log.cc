#include "tools/view/shown_log.h"

#include <charconv>
#include <string_view>
#include <utility>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"

namespace sinew::live {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json LogRow(const inspect::LogText& line) {
  return {{"level", NameOf(line.level)}, {"name", line.name}, {"text", line.text}};
}

void ShownLog::Add(inspect::LogText line) {
  const std::lock_guard<std::mutex> lock(mutex_);
  lines_.push_back(std::move(line));
  ++last_;
  if (lines_.size() > kMost) lines_.pop_front();
}

std::string ShownLog::After(const std::string& query) const {
  constexpr std::string_view kAfter = "after=";
  std::uint64_t after = 0;
  const char* const end = query.data() + query.size();
  if (query.size() <= kAfter.size() || !query.starts_with(kAfter) ||
      std::from_chars(query.data() + kAfter.size(), end, after).ptr != end) {
    throw UsageError("'" + query + "', expected after=N");
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  Json rows = Json::array();
  std::uint64_t number = last_ - lines_.size();
  for (const inspect::LogText& line : lines_) {
    if (++number <= after) continue;
    rows.push_back(LogRow(line));
    rows.back()["time_ms"] = static_cast<double>(line.time_ns) * 1e-6;
  }
  return types::JsonText(Json{{"last", last_}, {"lines", std::move(rows)}});
}

}  // namespace sinew::live
